//! Bodies that cannot be part of any pair of boxes: none are formed for them.
//!
//! A partner of a body is another body with which it may be a pair, by the layers of both. Bodies with the same layers
//! are of one kind, and have partners or not together.

use super::body::Body;
use super::layer_groups::LayerGroups;
use crate::layers::Layers;
use crate::orientation::Turning;
use crate::rounding::UNIT_ROUNDOFF;
use std::collections::BTreeMap;

/// The kinds of bodies in a scene: the number of bodies of each, the largest radius, and the presence of model errors.
#[derive(Clone, Debug, Default)]
pub(super) struct Kinds {
    /// By membership and filter of a kind: the number of bodies, and true if they have a partner; none of a new kind.
    layers: BTreeMap<(u32, u32), (usize, Option<bool>)>,
    /// Upper bound of the radii of all bodies so far, m: see [`rounded_up`].
    largest: f64,
    /// True if a body so far had a model error.
    pub(super) has_model_errors: bool,
    /// Changes when a kind gets its first partner or loses the last one, but not with the first body of a kind.
    version: u64,
}

impl Kinds {
    /// Beyond this number of different layers, each is assumed to have a partner.
    const MANY: usize = 64;

    pub(super) fn add(&mut self, body: &Body) {
        self.add_shape(body);
        self.add_layers(body.layers);
    }

    /// Includes the hitbox and the model error of a body.
    pub(super) fn add_shape(&mut self, body: &Body) {
        self.largest = self.largest.max(rounded_up(radius(body)));
        self.has_model_errors |= body.model_error() > 0.0;
    }

    pub(super) fn add_layers(&mut self, layers: Layers) {
        let key = (layers.membership, layers.filter);
        let (count, _) = self.layers.entry(key).or_default();
        *count += 1;
        if *count <= 2 {
            self.find_partners();
        }
    }

    pub(super) fn remove_layers(&mut self, layers: Layers) {
        let key = (layers.membership, layers.filter);
        if let Some((count, _)) = self.layers.get_mut(&key) {
            *count -= 1;
            match *count {
                0 => drop(self.layers.remove(&key)),
                1 => {}
                _ => return,
            }
            self.find_partners();
        }
    }

    /// Returns the different layers, and the number of bodies that have them.
    fn counts(&self) -> impl ExactSizeIterator<Item = (Layers, usize)> + Clone {
        let kinds = self.layers.iter();
        kinds.map(|(&(membership, filter), &(count, _))| (Layers::new(membership, filter), count))
    }

    /// Returns true if the layers of any two bodies admit each other; false if there are too many to tell.
    pub(super) fn admit_all(&self) -> bool {
        let kinds = self.counts();
        let admits = |own: Layers, other: Layers, count: usize| {
            own.admits(other) || own == other && count <= 1
        };
        let mut owns = kinds.clone();
        kinds.len() <= Self::MANY
            && owns.all(|(own, _)| {
                kinds
                    .clone()
                    .all(|(other, count)| admits(own, other, count))
            })
    }

    /// Returns the groups of the layers.
    pub(super) fn layer_groups(&self) -> LayerGroups {
        LayerGroups::of(self.counts().map(|(layers, _)| layers))
    }

    /// Updates which layers have a partner; a single body is no partner of itself.
    fn find_partners(&mut self) {
        let are_many = self.layers.len() > Self::MANY;
        let known: Vec<(Layers, usize)> = self.counts().take(Self::MANY).collect();
        for (&(membership, filter), (_, has_partner)) in self.layers.iter_mut().take(Self::MANY + 1)
        {
            let own = Layers::new(membership, filter);
            let admits = |&(other, count): &(Layers, usize)| {
                own.admits(other) && (own != other || count > 1)
            };
            let found = are_many || known.iter().any(admits);
            let before = has_partner.replace(found);
            self.version += u64::from(before.is_some_and(|before| before != found));
        }
    }
}

/// A test whether a body may be part of any pair of boxes with a margin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Partners<'s> {
    kinds: &'s Kinds,
    margin: f64,
    /// The answer for all bodies, by their layers, if it is the same.
    all: Option<bool>,
}

impl<'s> Partners<'s> {
    /// Returns the test for bodies of these kinds and a margin (m).
    pub(super) fn of(kinds: &'s Kinds, margin: f64) -> Self {
        let mut layers = kinds.layers.values().map(|kind| kind.1 == Some(true));
        let first = layers.next();
        // Beyond some number none is looked for.
        let are_alike = layers.take(Kinds::MANY).all(|other| Some(other) == first);
        let all = first.filter(|_| are_alike);
        Self { kinds, margin, all }
    }

    /// Returns false if the body can be part of no pair of boxes: by its layers, by a very negative
    /// margin, or because no box contains a half-space.
    #[inline]
    pub(crate) fn has(&self, body: &Body) -> bool {
        if body.hitbox.is_half_space() {
            return false;
        }
        let of_layers = || {
            let key = (body.layers.membership, body.layers.filter);
            let is_partner = || self.kinds.layers.get(&key).and_then(|kind| kind.1) == Some(true);
            self.kinds.layers.len() > Kinds::MANY || is_partner()
        };
        self.all.unwrap_or_else(of_layers)
            && (self.margin >= 0.0 || radii_may_meet(radius(body), self.kinds.largest, self.margin))
    }

    /// Returns a value that changes if [`has`](Self::has) changes for unchanged bodies.
    pub(crate) const fn version(&self) -> (u64, u64) {
        // Only a negative margin asks for radii.
        let largest = if self.margin >= 0.0 {
            0.0
        } else {
            self.kinds.largest
        };
        (self.kinds.version, largest.to_bits())
    }
}

/// Returns an upper bound of the radii of a body's spheres, m, to rounding. It includes the model error, and the error
/// of centres that turn, in any orientation that the body may be given. Infinite of a half-space.
pub(crate) fn radius(body: &Body) -> f64 {
    let hitbox = &body.hitbox;
    let reach = Turning::reach_at_most(hitbox.radius_around_position(), hitbox.arm());
    reach + body.model_error()
}

/// Returns an upper bound of a radius (m), less than a 64th larger. A scene has few different ones: whenever the largest
/// changes, a monitor goes through all bodies.
fn rounded_up(radius: f64) -> f64 {
    /// Bits of the mantissa that may differ between bounds.
    const BITS: u32 = 6;
    if radius == f64::INFINITY {
        return radius;
    }
    let others = (1 << (f64::MANTISSA_DIGITS - 1 - BITS)) - 1;
    f64::from_bits(radius.to_bits() | others)
}

/// Returns false if two radii and a margin (m) certainly add up to less than zero.
pub(crate) fn radii_may_meet(one: f64, other: f64, margin: f64) -> bool {
    let rounding = 4.0 * UNIT_ROUNDOFF * (one + other + margin.abs());
    one + other + margin >= -rounding
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failure fails the test")]

    use super::*;
    use crate::hitbox::Hitbox;
    use crate::trajectory::Trajectory;
    use glam::DVec3;

    fn rest() -> Body {
        Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap())
    }

    fn ball(radius: f64) -> Body {
        rest().with_hitbox(Hitbox::sphere(radius).unwrap())
    }

    /// Whoever sees another version goes through all bodies: not for each body that is larger than all before it.
    #[test]
    fn a_larger_body_is_another_version_where_radii_count() {
        let mut kinds = Kinds::default();
        let mut version_with = |radius: f64, margin: f64| {
            kinds.add(&ball(radius));
            Partners::of(&kinds, margin).version()
        };
        // The first two are partners from the second one on.
        let _ = [1.0, 2.0].map(|radius| version_with(radius, 0.0));
        let mut radius = 2.0;
        for (margin, changes) in [(0.0, false), (5.0, false), (-1.0, true)] {
            let before = version_with(radius, margin);
            radius += 1.0;
            let larger = version_with(radius, margin);
            assert_eq!(before != larger, changes, "{margin}");
            assert_eq!(larger, version_with(radius, margin));
        }
    }

    /// Few versions, however many bodies are a little larger than all before; and each version has the partners of all
    /// bodies that there are.
    #[test]
    fn slowly_rising_radii_are_few_versions() {
        const MARGIN: f64 = -1.5;
        let mut kinds = Kinds::default();
        let (mut versions, mut last, mut small_has_partner) = (0, None, 0);
        let small = ball(0.6);
        kinds.add(&small);
        for number in 0..2_000 {
            let large = ball(0.5 + 5e-4 * f64::from(number));
            kinds.add(&large);
            let partners = Partners::of(&kinds, MARGIN);
            versions += usize::from(last.replace(partners.version()) != Some(partners.version()));
            let can_meet = |other: &Body| radii_may_meet(radius(&large), radius(other), MARGIN);
            assert!(partners.has(&small) || !can_meet(&small), "{number}");
            assert!(partners.has(&large) || !can_meet(&large), "{number}");
            small_has_partner += usize::from(partners.has(&small));
        }
        // From 0.6 to 1 in steps of a 128th, and to 1.5 in steps of a 64th.
        assert!((80..=90).contains(&versions), "{versions}");
        assert!(
            (1_150..=1_250).contains(&small_has_partner),
            "{small_has_partner}"
        );
    }

    #[test]
    fn layers_admit_all_if_any_two_bodies_do() {
        for (layers, expected) in [
            (&[(1, 3), (2, 3), (u32::MAX, u32::MAX)][..], true),
            // A single body is no partner of itself.
            (&[(1, 2), (2, 3), (2, 3)], true),
            (&[(1, 2), (1, 2), (2, 3)], false),
            (&[(1, 1), (2, 2)], false),
        ] {
            let mut kinds = Kinds::default();
            for &(membership, filter) in layers {
                kinds.add(&rest().with_layers(Layers::new(membership, filter)));
            }
            assert_eq!(kinds.admit_all(), expected, "{layers:?}");
        }
    }

    #[test]
    fn bounds_of_radii_are_a_little_larger() {
        let mut radius = 1e-300;
        while radius < 1e300 {
            let bound = rounded_up(radius);
            assert!(
                radius <= bound && bound < radius * (1.0 + 1.0 / 64.0),
                "{radius}"
            );
            assert!(rounded_up(bound).to_bits() == bound.to_bits(), "{radius}");
            radius *= 1.037;
        }
        let ends = [0.0, f64::MAX, f64::INFINITY];
        assert!(ends.into_iter().all(|end| rounded_up(end) >= end));
        assert!(rounded_up(0.0) < f64::MIN_POSITIVE && rounded_up(f64::MAX) < f64::INFINITY);
    }

    /// Nobody has to go through all bodies if one comes and goes whose kind makes no difference to the others.
    #[test]
    fn a_kind_of_one_body_is_another_version_if_it_is_a_first_or_last_partner() {
        let body = |layers| rest().with_layers(layers);
        for (many, one, changes) in [
            (Layers::new(1, 3), Layers::new(2, 1), false),
            (Layers::new(1, 3), Layers::new(4, 4), false),
            (Layers::new(1, 2), Layers::new(2, 1), true),
        ] {
            let mut kinds = Kinds::default();
            (0..3).for_each(|_| kinds.add(&body(many)));
            let version = |kinds: &Kinds| Partners::of(kinds, 0.0).version();
            for _ in 0..3 {
                let before = version(&kinds);
                kinds.add(&body(one));
                let between = version(&kinds);
                let partners = Partners::of(&kinds, 0.0);
                assert_eq!(partners.has(&body(one)), one.admits(many), "{one:?}");
                assert!(partners.has(&body(many)));
                kinds.remove_layers(one);
                assert_eq!(before != between, changes, "{one:?}");
                assert_eq!(between != version(&kinds), changes, "{one:?}");
                assert_eq!(Partners::of(&kinds, 0.0).has(&body(many)), !changes);
            }
        }
    }
}
