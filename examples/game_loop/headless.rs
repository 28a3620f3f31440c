//! The game at 60 Hz of simulated time, without a window: how long a tick takes, what happened.

use crate::fleet::{Fleet, LOOKAHEAD, WARNING};
use crate::tally::Tally;
use crate::{Arguments, Avoid};
use std::error::Error as StdError;
use std::time::Instant;

/// Ticks of simulated time a second.
const RATE: f64 = 60.0;

/// Runs the game and returns its line of JSON.
pub(crate) fn run(arguments: &Arguments) -> Result<String, Box<dyn StdError + Send + Sync>> {
    if !(0.0..=1.0).contains(&arguments.replan) {
        return Err(format!(
            "--replan {} is not a share between 0 and 1",
            arguments.replan
        )
        .into());
    }
    let ticks = ticks(arguments.seconds)?;
    let mut fleet = Fleet::new(arguments.bodies, arguments.seed)?;
    let mut tally = Tally::default();
    let mut events = Vec::new();
    // What lies ahead at the start is found before the clock runs.
    fleet.monitor.advance(0.0, &mut events)?;
    tally.read(&events);
    let mut times = Vec::with_capacity(ticks as usize);
    let (mut replans, mut lag) = (0, 0.0_f64);
    for tick in 1..=ticks {
        let mut plans = fleet.whims(arguments.replan)?;
        let running_out = Fleet::running_out(&events);
        for id in running_out {
            if plans.iter().all(|&(planned, _)| planned != id) {
                plans.extend(fleet.fresh_plan(id)?);
            }
        }
        if arguments.avoid == Avoid::On {
            plans = fleet.steer(plans)?;
        }
        replans += plans.len();
        let commands = fleet.commands(plans);
        let now = f64::from(tick) / RATE;
        events.clear();
        let begin = Instant::now();
        fleet.monitor.apply(commands)?;
        fleet.monitor.advance(now, &mut events)?;
        times.push(begin.elapsed().as_secs_f64() * 1e3);
        tally.read(&events);
        tally.check(&fleet);
        lag = lag.max(now + LOOKAHEAD - fleet.monitor.certified_until());
    }
    let conflicts = fleet.monitor.conflicts(WARNING).len();
    events.clear();
    fleet.monitor.close(&mut events);
    tally.read(&events);
    tally.finish();
    times.sort_unstable_by(f64::total_cmp);
    Ok(format!(
        "{{\"ticks\":{ticks},\"tick_ms_p50\":{:.3},\"tick_ms_p99\":{:.3},\"tick_ms_max\":{:.3},\
         \"replans\":{replans},\"conflicts\":{conflicts},\"events\":{{\"predicted\":{},\
         \"revised\":{},\"withdrawn\":{},\"began\":{},\"ended\":{}}},\"collisions\":{},\
         \"lost\":{},\"certified_lag_s\":{lag}}}",
        percentile(&times, 50),
        percentile(&times, 99),
        percentile(&times, 100),
        tally.predicted,
        tally.revised,
        tally.withdrawn,
        tally.began,
        tally.ended,
        tally.collisions,
        tally.lost,
    ))
}

/// The smallest time that this share of the ticks, in percent, does not exceed.
fn percentile(sorted: &[f64], percent: usize) -> f64 {
    let place = (sorted.len() * percent).div_ceil(100).max(1) - 1;
    sorted.get(place).copied().unwrap_or(0.0)
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "checked: a whole number between 1 and 2^32"
)]
fn ticks(seconds: f64) -> Result<u32, String> {
    let ticks = (seconds * RATE).round();
    if (1.0..=f64::from(u32::MAX)).contains(&ticks) {
        Ok(ticks as u32)
    } else {
        Err(format!("--seconds {seconds} makes no number of ticks"))
    }
}
