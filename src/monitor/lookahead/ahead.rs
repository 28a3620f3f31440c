//! Work on the slice that comes next, spread over ticks.

/// Returns the share of the work on the next slice that is due.
///
/// - `share`: the part that has passed of the time between two slices becoming needed, the last one and the next, 0 to 1;
/// - `step`: the part of it that has passed since the tick before;
/// - the number of bodies that changed since the tick before, and that of all bodies.
///
/// Work done ahead is repeated for each body that changes after it. So if many bodies change, work begins
/// late. It does not begin so late that single ticks take much longer: a tick takes on half as many bodies as have
/// changed.
#[allow(
    clippy::cast_precision_loss,
    reason = "numbers of bodies, of which a rough share is wanted"
)]
pub(super) fn share_due_ahead(share: f64, step: f64, (changed, all): (usize, usize)) -> f64 {
    // Ticks between two slices that become needed.
    let in_all = 1.0 / step.max(f64::MIN_POSITIVE);
    // Ticks that share the work. The quotient is infinite or not a number if nobody has changed: then all ticks do.
    let ticks = (2.0 * all as f64 / changed as f64).min(in_all);
    (1.0 - (1.0 - share) * in_all / ticks).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::share_due_ahead;

    #[test]
    fn work_ahead_is_even_where_few_change_and_late_where_many_do() {
        let ahead = |tick: f64, changed| share_due_ahead(tick / 60.0, 1.0 / 60.0, (changed, 1000));
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
        assert!(share_due_ahead(0.5, 0.0, (1, 1000)) <= 0.0);
        assert!((share_due_ahead(0.5, 0.0, (0, 0)) - 0.5).abs() < 1e-12);
    }
}
