//! Work on the slice that comes next, spread over ticks.

/// Returns the share of the slice that comes next that is due when `share` of the time until it is needed has
/// passed, the last `step` of it since the tick before, in which so many out of all bodies changed.
///
/// Work done ahead is done again for each body that changes after. So work begins late where many bodies
/// change, but not so late that it stands out: a tick takes on half as many bodies as have changed.
#[allow(
    clippy::cast_precision_loss,
    reason = "numbers of bodies, of which a rough share is wanted"
)]
pub(super) fn due_ahead(share: f64, step: f64, (changed, all): (usize, usize)) -> f64 {
    let in_all = 1.0 / step.max(f64::MIN_POSITIVE);
    // Not a number, or infinite, if nobody has changed: then all the ticks that there are.
    let ticks = (2.0 * all as f64 / changed as f64).min(in_all);
    (1.0 - (1.0 - share) * in_all / ticks).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::due_ahead;

    #[test]
    fn work_ahead_is_even_where_few_change_and_late_where_many_do() {
        let ahead = |tick: f64, changed| due_ahead(tick / 60.0, 1.0 / 60.0, (changed, 1000));
        for tick in 0..=60 {
            let tick = f64::from(tick);
            // Too few to be in the way, or nobody.
            for changed in [0, 33] {
                assert!((ahead(tick, changed) - tick / 60.0).abs() < 1e-12);
            }
            // In the last twenty ticks.
            let late = ((tick - 40.0) / 20.0).max(0.0);
            assert!((ahead(tick, 100) - late).abs() < 1e-12, "{tick}");
        }
        assert!(ahead(58.0, 1000) < 1e-12 && ahead(59.0, 1000) > 0.4 && ahead(60.0, 1000) >= 1.0);
        // Nothing comes nearer while the clock stands.
        assert!(due_ahead(0.5, 0.0, (1, 1000)) <= 0.0);
        assert!((due_ahead(0.5, 0.0, (0, 0)) - 0.5).abs() < 1e-12);
    }
}
