//! The game at 60 Hz of simulated time, without a window: how long a tick takes, what happened.

use crate::fleet::{LOOKAHEAD, Setting};
use crate::game::Game;
use crate::truth::Truth;
use crate::{Arguments, Avoid, Failure};

/// Ticks of simulated time a second.
const RATE: f64 = 60.0;

/// Ticks after which all positions are checked. The check goes through all bodies, which takes
/// the monitor's own data out of the caches.
const CHECK: u32 = 6;

/// Runs the game and returns its line of JSON.
pub(crate) fn run(arguments: &Arguments) -> Result<String, Failure> {
    let ticks = ticks(arguments.seconds);
    let (setting, bodies) = if arguments.ships {
        (Setting::SHIPS, crate::SHIPS)
    } else {
        (Setting::STRESS, 1_000)
    };
    let bodies = arguments.bodies.unwrap_or(bodies);
    let mut game = Game::new(setting, bodies, arguments.seed)?;
    let mut truth = arguments.ships.then(Truth::default);
    if let Some(truth) = &mut truth {
        // Spheres are looked at within ticks that are over.
        game.fleet.monitor.set_history(2.0 / RATE)?;
        truth.read(setting.contact, &game.events);
    }
    game.replan = arguments.replan;
    game.avoids = arguments.avoid == Avoid::On;
    let mut times = Vec::with_capacity(ticks as usize);
    let mut lag = 0.0_f64;
    for tick in 1..=ticks {
        let now = f64::from(tick) / RATE;
        times.push(game.tick(now)?.as_secs_f64() * 1e3);
        if let Some(truth) = &mut truth {
            truth.read(setting.contact, &game.events);
            truth.look(&game.fleet, (f64::from(tick - 1) / RATE, now));
        } else if tick % CHECK == 0 {
            game.tally.check(&game.fleet)?;
        }
        lag = lag.max(now + LOOKAHEAD - game.fleet.monitor.complete_until());
    }
    let Game {
        fleet,
        mut tally,
        mut events,
        replans,
        ..
    } = game;
    let conflicts = fleet.monitor.conflicts(fleet.setting.warning)?.len();
    events.clear();
    fleet.monitor.close(&mut events);
    tally.read(fleet.setting.contact, &events);
    tally.finish();
    times.sort_unstable_by(f64::total_cmp);
    let unpredicted = truth.map_or(String::new(), |truth| {
        let Truth {
            grounded,
            unpredicted,
            ..
        } = truth;
        format!(",\"grounded\":{grounded},\"unpredicted\":{unpredicted}")
    });
    Ok(format!(
        "{{\"ticks\":{ticks},\"tick_ms_p50\":{:.3},\"tick_ms_p99\":{:.3},\"tick_ms_max\":{:.3},\
         \"replans\":{replans},\"conflicts\":{conflicts},\"events\":{{\"predicted\":{},\
         \"revised\":{},\"withdrawn\":{},\"began\":{},\"ended\":{}}},\"collisions\":{},\
         \"lost\":{},\"lag_s\":{lag}{unpredicted}}}",
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
pub(crate) fn percentile(sorted: &[f64], percent: usize) -> f64 {
    let place = (sorted.len() * percent).div_ceil(100).max(1) - 1;
    sorted.get(place).copied().unwrap_or(0.0)
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the command line allows 0.01 s to 1e6 s: 1 to 6e7"
)]
fn ticks(seconds: f64) -> u32 {
    (seconds * RATE).round() as u32
}
