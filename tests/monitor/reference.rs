//! A plain model of the monitor: what the rules say, from one-shot screenings alone.
//!
//! At each tick the scene is screened from where the last tick's clock stood to the end of what is
//! known, at every level. What comes out is matched, pair by pair and in order, with what was there
//! before; everything else follows. Nothing is kept between ticks but what was reported to a listener.

use nearmiss::{
    AlertLevel, Body, BodyId, ClosestApproach, Conflict, EndReason, Event, EventKind, Query, Scene,
    Trajectory, Window,
};
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// An encounter as it was last reported.
#[derive(Clone, Copy)]
struct Followed {
    enter: f64,
    exit: f64,
    open: bool,
    closest: ClosestApproach,
    /// What was last sent of it: enter, exit, open, closest.
    sent: (f64, f64, bool, ClosestApproach),
    has_begun: bool,
    /// It ends with a trajectory.
    is_last: bool,
    /// The closest that the clock has passed.
    passed: Option<ClosestApproach>,
}

impl Followed {
    fn reason_of_end(&self) -> EndReason {
        if self.is_last {
            EndReason::TrajectoryEnded
        } else {
            EndReason::Separated
        }
    }
}

/// An encounter as the plans have it now.
struct Planned {
    /// First instant within the margin.
    enter: Option<f64>,
    /// First instant within the release margin.
    start: f64,
    exit: f64,
    /// It goes on where knowledge ends.
    open: bool,
    /// It ends with a trajectory.
    is_last: bool,
    closest: ClosestApproach,
}

/// An event without its id.
pub(crate) type Reported = (f64, u8, BodyId, BodyId, usize, Vec<u64>);

pub(crate) struct Reference {
    levels: Vec<AlertLevel>,
    lookahead: f64,
    /// By level and pair, in order of time.
    followed: Vec<BTreeMap<(BodyId, BodyId), Vec<Followed>>>,
    /// Up to where clock events were reported.
    before: f64,
    /// The plans at the last tick, and whether their end was reported.
    plans: BTreeMap<BodyId, (Trajectory, bool)>,
}

/// Times of one tick.
#[derive(Clone, Copy)]
struct Tick {
    now: f64,
    reported: f64,
    before: f64,
    known: f64,
    lookahead: f64,
}

impl Reference {
    pub(crate) fn new(levels: &[AlertLevel], now: f64, lookahead: f64) -> Self {
        Self {
            levels: levels.to_vec(),
            lookahead,
            followed: vec![BTreeMap::new(); levels.len()],
            before: now,
            plans: BTreeMap::new(),
        }
    }

    /// The events of a tick after which everything up to `known` is known, in no order.
    pub(crate) fn tick(&mut self, scene: &Scene, now: f64, known: f64) -> Vec<Reported> {
        let tick = Tick {
            now,
            reported: now.min(known),
            before: self.before,
            known,
            lookahead: self.lookahead,
        };
        let mut reported = Vec::new();
        for level in 0..self.levels.len() {
            let mut planned = planned(scene, self.levels[level], &tick);
            let mut pairs: Vec<_> = self.followed[level].keys().copied().collect();
            pairs.extend(planned.keys().copied());
            pairs.sort_unstable();
            pairs.dedup();
            for pair in pairs {
                let old = self.followed[level].remove(&pair).unwrap_or_default();
                let new = planned.remove(&pair).unwrap_or_default();
                let mut tell = |time: f64, kind: u8, encounter: &Followed, reason: u64| {
                    let numbers = numbers(encounter, reason);
                    reported.push((time, kind, pair.0, pair.1, level, numbers));
                };
                let left = follow(scene, pair, old, new, &tick, &mut tell);
                if !left.is_empty() {
                    self.followed[level].insert(pair, left);
                }
            }
        }
        self.plan_ends(scene, now, &mut reported);
        self.before = tick.reported;
        reported
    }

    fn plan_ends(&mut self, scene: &Scene, now: f64, reported: &mut Vec<Reported>) {
        let old = std::mem::take(&mut self.plans);
        for (id, Body { trajectory, .. }) in scene.bodies() {
            let was_told = old
                .get(&id)
                .is_some_and(|(plan, was_told)| plan == trajectory && *was_told);
            let end = trajectory.domain().end();
            let is_due = end <= now + self.lookahead;
            if is_due && !was_told {
                reported.push((end, 5, id, id, 0, Vec::new()));
            }
            self.plans.insert(id, (trajectory.clone(), is_due));
        }
    }
}

/// What screening says of a level, by pair.
fn planned(
    scene: &Scene,
    level: AlertLevel,
    tick: &Tick,
) -> BTreeMap<(BodyId, BodyId), Vec<Planned>> {
    let mut found: BTreeMap<_, Vec<Planned>> = BTreeMap::new();
    // Up to an instant that was reached before, nothing new is known.
    if tick.known <= tick.before {
        return found;
    }
    let window = Window::new(tick.before, tick.known).unwrap();
    let screen = |margin: f64| -> Vec<Conflict> {
        let query = Query::new(window).with_margin(margin);
        scene.screen(&query).unwrap().conflicts
    };
    let within = screen(level.margin);
    for held in screen(level.release) {
        let of_this = |conflict: &&Conflict| {
            (conflict.a, conflict.b) == (held.a, held.b)
                && held.enter <= conflict.enter
                && conflict.exit <= held.exit
        };
        let ends = [held.a, held.b].map(|id| scene.body(id).unwrap().trajectory.domain().end());
        let end = ends[0].min(ends[1]);
        found.entry((held.a, held.b)).or_default().push(Planned {
            enter: within.iter().find(of_this).map(|conflict| conflict.enter),
            start: held.enter,
            exit: held.exit,
            open: held.exit >= tick.known && end > tick.known,
            is_last: held.exit >= end,
            closest: held.closest,
        });
    }
    found
}

/// Follows the encounters of one pair at one level through a tick.
fn follow(
    scene: &Scene,
    pair: (BodyId, BodyId),
    old: Vec<Followed>,
    new: Vec<Planned>,
    tick: &Tick,
    tell: &mut impl FnMut(f64, u8, &Followed, u64),
) -> Vec<Followed> {
    let is_there = scene.body(pair.0).is_some() && scene.body(pair.1).is_some();
    let mut left = Vec::new();
    let mut old = old.into_iter().peekable();
    let mut new = new.into_iter().peekable();
    loop {
        let matches = match (old.peek(), new.peek()) {
            (None, None) => return left,
            (Some(_), None) => (true, false),
            (None, Some(_)) => (false, true),
            (Some(x), Some(y)) => {
                let is_over = if x.has_begun {
                    y.start > tick.before
                } else {
                    !x.open && x.exit < y.enter.unwrap_or(y.start)
                };
                if is_over {
                    (true, false)
                } else {
                    (y.exit >= x.enter, true)
                }
            }
        };
        let followed = if matches.0 { old.next() } else { None };
        let planned = if matches.1 { new.next() } else { None };
        match (followed, planned) {
            (Some(followed), None) => {
                left.extend(gone(followed, is_there, tick, tell));
            }
            // Only the release margin is left of what had not begun.
            (Some(followed), Some(planned)) if !followed.has_begun && planned.enter.is_none() => {
                left.extend(gone(followed, is_there, tick, tell));
            }
            (followed, Some(planned)) => {
                left.extend(go_on(scene, pair, followed, &planned, tick, tell));
            }
            (None, None) => unreachable!("one of the two is taken"),
        }
    }
}

/// The plans no longer have it.
fn gone(
    followed: Followed,
    is_there: bool,
    tick: &Tick,
    tell: &mut impl FnMut(f64, u8, &Followed, u64),
) -> Option<Followed> {
    // Where nothing is known nothing is said.
    let unknown = if followed.has_begun {
        tick.known <= tick.before
    } else {
        followed.enter > tick.known
    };
    if is_there && unknown {
        return Some(followed);
    }
    // What ended at the very instant that was reported last had ended by its plans. They may be forgotten.
    let has_ended = followed.has_begun && !followed.open && followed.exit <= tick.before;
    let reason = match (is_there, has_ended) {
        (false, _) => EndReason::BodyRemoved,
        (true, true) => followed.reason_of_end(),
        (true, false) => EndReason::PlanChanged,
    };
    if followed.has_begun {
        // What was reported up to then stays.
        let ended = Followed {
            exit: tick.before,
            open: false,
            closest: followed.passed.unwrap_or(followed.closest),
            ..followed
        };
        tell(tick.before, 4, &ended, reason as u64 + 1);
    } else {
        let time = if is_there { tick.now } else { tick.before };
        tell(time, 2, &followed, 0);
    }
    None
}

/// The plans have it (still, or newly).
fn go_on(
    scene: &Scene,
    (a, b): (BodyId, BodyId),
    followed: Option<Followed>,
    planned: &Planned,
    tick: &Tick,
    tell: &mut impl FnMut(f64, u8, &Followed, u64),
) -> Option<Followed> {
    let is_new = followed.is_none();
    let mut this = match followed {
        Some(followed) => followed,
        None => Followed {
            // Within the release margin alone nothing begins.
            enter: planned.enter?,
            exit: planned.exit,
            open: planned.open,
            closest: planned.closest,
            sent: (planned.enter?, planned.exit, planned.open, planned.closest),
            has_begun: false,
            is_last: false,
            passed: None,
        },
    };
    if is_new && this.enter > tick.reported {
        tell(tick.now, 0, &this, 0);
    }
    (this.exit, this.open, this.closest) = (planned.exit, planned.open, planned.closest);
    this.is_last = planned.is_last;
    if this.has_begun {
        // A new plan never rewrites the past.
        this.closest = nearer(this.passed, this.closest);
    } else {
        this.enter = planned.enter.unwrap_or(this.enter);
    }
    let is_revised = !is_new && is_revised(&this, tick);
    if !this.has_begun && this.enter <= tick.reported {
        this.has_begun = true;
        tell(this.enter, 3, &this, 0);
        // What this does not know is told again once it is known.
        this.sent.2 |= this.open;
        if this.open && this.closest.time >= this.exit {
            (this.sent.1, this.sent.3) = (this.exit, this.closest);
        }
    }
    if this.has_begun {
        let end = this.exit.min(tick.reported);
        if planned.start <= end {
            let flown = Window::new(planned.start, end).unwrap();
            let least = scene.closest_approach(a, b, flown).unwrap().unwrap();
            this.passed = Some(nearer(this.passed, least));
        }
        if !this.open && this.exit < tick.reported {
            tell(this.exit, 4, &this, this.reason_of_end() as u64 + 1);
            return None;
        }
    }
    if is_revised {
        tell(tick.now, 1, &this, 0);
        this.sent = (this.enter, this.exit, this.open, this.closest);
    }
    Some(this)
}

/// Returns the closest approach that has passed, unless the planned one is nearer: where the distance is constant, by more
/// than rounding.
fn nearer(passed: Option<ClosestApproach>, planned: ClosestApproach) -> ClosestApproach {
    let is_constant = |one: &ClosestApproach| one.relative_velocity.length() < 1e-12;
    match passed {
        Some(passed) => {
            let rounding = if is_constant(&passed) && is_constant(&planned) {
                1e-12
            } else {
                0.0
            };
            if passed.separation <= planned.separation + rounding {
                passed
            } else {
                planned
            }
        }
        None => planned,
    }
}

/// Whether what is known differs at all from what was sent. The end of what is known moves: what
/// lies at it, or beyond it, is no number yet, and reported once a lookahead only.
fn is_revised(this: &Followed, tick: &Tick) -> bool {
    let (enter, exit, open, closest) = this.sent;
    if this.enter != enter {
        return true;
    }
    let exit_differs = match (this.open, open) {
        (false, false) => this.exit != exit,
        (true, true) => false,
        (true, false) => this.exit > exit,
        (false, true) => true,
    };
    // At an open end the bodies may still be closing in.
    let is_sent = !(open && closest.time >= exit);
    let is_known = !(this.open && this.closest.time >= this.exit);
    let nearer = this.closest.separation < closest.separation;
    let differs =
        this.closest.time != closest.time || this.closest.separation != closest.separation;
    let is_hidden = this.open && closest.time > this.exit;
    let closest_differs = match (is_sent, is_hidden) {
        (false, _) => is_known || nearer && this.closest.time >= closest.time + tick.lookahead,
        (true, true) => is_known && nearer,
        (true, false) => !is_known || differs,
    };
    exit_differs || closest_differs
}

fn numbers(encounter: &Followed, reason: u64) -> Vec<u64> {
    vec![
        encounter.enter.to_bits(),
        encounter.exit.to_bits(),
        u64::from(encounter.open),
        encounter.closest.time.to_bits(),
        encounter.closest.separation.to_bits(),
        reason,
    ]
}

/// By time, kind, bodies and level, then whatever else is reported.
pub(crate) fn order(x: &Reported, y: &Reported) -> Ordering {
    let key = |reported: &Reported| {
        (
            reported.1,
            reported.2,
            reported.3,
            reported.4,
            reported.5.clone(),
        )
    };
    x.0.total_cmp(&y.0).then_with(|| key(x).cmp(&key(y)))
}

/// The monitor's own events in the same form.
pub(crate) fn reported(event: &Event) -> Reported {
    let (kind, encounter, reason) = match event.kind {
        EventKind::Predicted(encounter) => (0, encounter, 0),
        EventKind::Revised(encounter) => (1, encounter, 0),
        EventKind::Withdrawn(encounter) => (2, encounter, 0),
        EventKind::Began(encounter) => (3, encounter, 0),
        EventKind::Ended(encounter, reason) => (4, encounter, reason as u64 + 1),
        EventKind::PlanEnds { body, .. } => return (event.time, 5, body, body, 0, Vec::new()),
        _ => panic!("an event without a rule: {event:?}"),
    };
    let numbers = vec![
        encounter.enter.to_bits(),
        encounter.exit.to_bits(),
        u64::from(encounter.open),
        encounter.closest.time.to_bits(),
        encounter.closest.separation.to_bits(),
        reason,
    ];
    (
        event.time,
        kind,
        encounter.a,
        encounter.b,
        encounter.level,
        numbers,
    )
}
