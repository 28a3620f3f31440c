//! The pairs that a scene admits: by layers, ignored pairs, and radii where the margin is negative.

use super::Scene;
use super::layer_groups::LayerGroups;
use super::partners::{Partners, can_reach, radius};
use crate::layers::Layers;

impl Scene {
    /// Returns the test whether a body has a partner: another body with which it may be a pair within a margin (m).
    pub(crate) fn partners(&self, margin: f64) -> Partners<'_> {
        Partners::of(&self.kinds, margin)
    }

    /// Returns true if any two bodies may be a pair with a margin (m).
    pub(crate) fn admits_all(&self, margin: f64) -> bool {
        margin >= 0.0 && self.ignored.is_empty() && self.kinds.admit_all()
    }

    /// Returns the groups of the bodies by their layers.
    pub(crate) fn layer_groups(&self) -> LayerGroups {
        self.kinds.layer_groups()
    }

    /// Returns true if the bodies of two slots may be a pair with a margin (m): by layers, ignored
    /// pairs, and radii, which a negative margin may exceed.
    pub(crate) fn admits(&self, a: u32, b: u32, margin: f64) -> bool {
        let [Some(key_a), Some(key_b)] = [a, b].map(|slot| self.taken(slot)) else {
            return false;
        };
        // Bodies are fetched only where it matters: one that is not cached takes as long as many comparisons.
        let [of_a, of_b] = [a, b].map(|slot| self.layers[slot as usize]);
        of_a.admits(of_b)
            && (margin >= 0.0 || self.can_reach(a, b, margin))
            && (self.ignored.is_empty() || !self.ignored.contains(key_a.id(a), key_b.id(b)))
    }

    /// Returns the layers of the body in a slot, if there is one.
    pub(crate) fn layers(&self, slot: u32) -> Option<Layers> {
        self.taken(slot).map(|_| self.layers[slot as usize])
    }

    /// Returns true if the spheres of two bodies may be within a margin (m), which is negative.
    fn can_reach(&self, a: u32, b: u32, margin: f64) -> bool {
        let radius = |slot| self.in_slot(slot).map(|(_, entry)| radius(&entry.body));
        let (Some(one), Some(other)) = (radius(a), radius(b)) else {
            return false;
        };
        can_reach(one, other, margin)
    }
}
