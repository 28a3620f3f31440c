//! Splices are the same plans in any form.

use crate::trajectory::{Outside, State, Trajectory};
use crate::window::Window;
use glam::DVec3;

fn plan(knots: &[f64], outside: Outside) -> Trajectory {
    let state = |&time: &f64| State::new(time, DVec3::X * time.sin(), DVec3::Y);
    let plan = match knots {
        [only] => Trajectory::coasting(state(only)),
        _ => Trajectory::from_states(&knots.iter().map(state).collect::<Vec<_>>()),
    };
    let plan = plan.unwrap_or_else(|_| unreachable!());
    plan.with_outside(outside)
}

/// Includes splices beyond the knots, where cuts are copied.
#[test]
fn what_is_not_copied_is_what_would_be_forgotten() {
    let instants: Vec<f64> = (-4..45).map(f64::from).collect();
    let mut seen = [0; 2];
    for outside in [Outside::Absent, Outside::Coast, Outside::Extrapolate] {
        for knots in [&[3.0][..], &[2.0, 3.0], &[0.0, 1.0, 2.0, 3.0]] {
            let old = plan(knots, outside);
            for plan in [&[3.0][..], &[10.0, 11.0]].map(|knots| plan(knots, outside)) {
                for &from in &instants {
                    let Ok(whole) = old.spliced(from, &plan) else {
                        continue;
                    };
                    for &since in &instants {
                        let mut spliced = plan.clone();
                        assert!(spliced.precede_by(&old, from, since).is_ok());
                        let since = whole.clone().trimmed_before(since);
                        assert_eq!(spliced, since, "{old:?} {plan:?} {from}");
                        let has_dropped = since.knots().len() < whole.knots().len();
                        seen[usize::from(has_dropped)] += 1;
                    }
                }
            }
        }
    }
    assert!(seen.iter().all(|&count| count > 1_000), "{seen:?}");
}

/// Plans of any kind have spare places for the rest of the previous one: their own knots stay where they are.
#[test]
fn told_frame_by_frame_a_plan_keeps_its_memory() {
    let last_knot = |plan: &mut Trajectory| plan.as_lists().knots.last().map(std::ptr::from_ref);
    let mut old = plan(&[0.0], Outside::Coast);
    for now in (1..100).map(f64::from) {
        let next = match now % 3.0 {
            1.0 => plan(&[now], Outside::Coast),
            2.0 => plan(&[now, now + 0.1], Outside::Extrapolate),
            _ => plan(&[now + 2.0], Outside::Coast),
        };
        let mut spliced = next.clone();
        let memory = last_knot(&mut spliced);
        assert!(spliced.precede_by(&old, now, now).is_ok());
        assert_eq!(last_knot(&mut spliced), memory, "{now}");
        old = spliced;
    }
}

/// A plan replaced in place is what one with lists is, wherever there is room for it.
#[test]
fn what_is_replaced_in_place_is_the_same_plan() {
    let (mut in_place, mut many, mut checked, mut extended, mut moved) = (0, 0, 0, 0, 0);
    for round in 0..200_u32 {
        let ahead = [5.0, 7.0, 100.0, 1e6][(round % 4) as usize];
        let window = |from: f64| Window::new(from - 1.0, from + ahead).unwrap_or(Window::ALL);
        let mut one = plan(&[0.0, 1.0, 2.0], Outside::Coast);
        let mut other = one.clone();
        let mut now = 2.0;
        for frame in 0..40_u32 {
            // Usually each frame, at times long after, or with what was before.
            let mix = (round * 41 + frame).wrapping_mul(2_654_435_761) >> 16;
            now += [0.1, 0.5, 3.0, 7.0, 40.0][(mix % 9).saturating_sub(4) as usize];
            let history = [0.0, 0.1, 0.5, 20.0][(mix / 9 % 7).saturating_sub(3) as usize];
            // Some keep more than there is room for in place.
            let since = now - if round % 20 == 0 { 20.0 } else { history };
            let age = [0.0, 0.0, 2.0, 1e9][(mix / 63 % 4) as usize];
            let velocity = DVec3::new(f64::from(mix % 5), 1.0, 0.1);
            let state = State::new(now - age, DVec3::X * f64::from(mix % 7), velocity);
            let Ok(motion) = Trajectory::coasting_motion(&state) else {
                unreachable!("it is usable")
            };
            assert!(one.can_replace((now, since), &motion, window(now)));
            assert!(other.can_replace((now, since), &motion, window(now)));
            let first = one.piece_knots()[0];
            let last = one.last_motion();
            let is_checked = last.is_replaced_by(&motion, now, (first, now - 1.0), now + ahead);
            if is_checked {
                checked += 1;
                assert!(one.domain().contains(now) && !one.follows(&motion, now));
            }
            let memory = one.straight_motions().as_ptr();
            if is_checked {
                let last = one.replace_checked(now, &motion, since);
                assert_eq!(last, one.last_motion());
            } else {
                one.replace(now, &motion, since);
            }
            if is_checked && let Ok(extension) = one.extension(window(now)) {
                let after = extension.map(|extension| (extension.after, extension.domain.1));
                let own = (0, one.piece_knots().last().copied().unwrap_or_default());
                assert_eq!(after.unwrap_or(own), one.pieces_after(now + ahead));
                extended += usize::from(after.is_some());
            }
            let is_kept = memory == one.straight_motions().as_ptr();
            moved += usize::from(is_checked && !is_kept);
            other.as_lists().replace(now, &motion, since);
            in_place += usize::from(!one.straight_motions().is_empty());
            many += usize::from(one.straight_motions().len() > 6);
            assert_eq!(
                (one.knots(), one.piece_knots()),
                (other.knots(), other.piece_knots())
            );
            assert_eq!(one.segments(), other.segments());
            assert_eq!(one.segment_after(), other.segment_after());
            assert_eq!(one.outside_before(), other.outside_before());
            for time in [now - 3.0, now - 0.05, now, now + 1.0, now + 99.0] {
                assert_eq!(one.state(time), other.state(time));
            }
        }
    }
    let counts = [in_place, many, checked, extended, moved];
    assert!(
        in_place > 5_000 && many > 100 && checked > 1_000 && extended > 500,
        "{counts:?}"
    );
    // To other memory where more are kept than there is room for, and back.
    assert!(moved < checked / 10, "{counts:?}");
}

/// Another rule lets it go on there.
#[test]
fn the_motion_before_a_splice_at_the_first_knot_stays() {
    let old = plan(&[2.0, 3.0], Outside::Absent);
    let spliced = old.spliced(2.0, &plan(&[4.0], Outside::Coast));
    let spliced = spliced.and_then(|once| once.spliced(5.0, &plan(&[5.0], Outside::Coast)));
    let place = |plan: &Trajectory| plan.clone().with_outside(Outside::Coast).position(0.0);
    let places = spliced.map(|spliced| [&old, &spliced].map(place));
    let Ok([Some(before), Some(after)]) = places else {
        unreachable!("it goes on before its first knot")
    };
    assert!(before.distance(after) < 1e-12, "{before} {after}");
}

/// Bodies that are told again for the same instant or an earlier one, and states that lie ahead.
#[test]
fn what_is_told_again_or_ahead_is_the_same_plan() {
    let mut counts = [0; 4];
    for round in 0..400_u32 {
        // Some follow a plan at first.
        let knots = [0.0, 0.5, 1.25, 400.0];
        let mut one = match round % 4 {
            0 => plan(&knots, Outside::Absent),
            1 => plan(&knots, Outside::Extrapolate),
            _ => plan(&[0.0], Outside::Coast),
        };
        let mut other = one.clone();
        let (mut now, mut from, mut since) = (1.0_f64, 1.0_f64, 0.5_f64);
        for frame in 0..40_u32 {
            let mix = (round * 41 + frame).wrapping_mul(2_654_435_761) >> 16;
            since = since.max(now - [0.0, 0.0, 0.1, 0.5][(mix % 4) as usize]);
            now += [0.1, 0.1, 0.3, 8.0][(mix / 4 % 7).saturating_sub(3) as usize];
            from = [now, now, from, since, since - 0.02][(mix / 28 % 5) as usize];
            from = from.max(other.domain().start());
            let ahead = [0.0, 0.05, 0.25, 5.0, 7.0, 500.0, -2.0][(mix / 140 % 7) as usize];
            let (x, y) = (f64::from(mix % 7), f64::from(mix % 5));
            let state = State::new(from + ahead, DVec3::X * x, DVec3::new(0.1, y, 1.0));
            let motion = Trajectory::coasting_motion(&state).unwrap_or_else(|_| unreachable!());
            let mut next = Trajectory::of_straight(motion);
            next.as_lists();
            assert!(next.precede_by(&other, from, since).is_ok());
            let is_back = one.knots().last().is_some_and(|&last| from <= last);
            let window = Window::new(since - 1.0, now + 9.0).unwrap_or(Window::ALL);
            if one.can_replace((from, since), &motion, window) {
                one.replace(from, &motion, since);
                counts[usize::from(is_back) + 2 * usize::from(ahead > 0.0)] += 1;
            } else {
                let mut plan = Trajectory::of_straight(motion);
                assert!(plan.precede_by(&one, from, since).is_ok());
                one = plan;
            }
            other = next.clone();
            assert_eq!(one.knots(), other.knots(), "{round} {frame}");
            next.as_lists().add_piece_after();
            assert_eq!(one.piece_knots(), next.piece_knots());
            assert_eq!(one.segments(), other.segments());
            assert_eq!(one.segment_after(), other.segment_after());
            assert_eq!(one.outside_before(), other.outside_before());
            for time in [since, now - 0.05, from, now, now + 1.0, now + 99.0] {
                assert_eq!(one.state(time), other.state(time));
            }
        }
    }
    assert!(counts.iter().all(|&count| count > 300), "{counts:?}");
}
