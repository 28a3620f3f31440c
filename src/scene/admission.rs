//! The pairs that a scene admits: by layers, ignored pairs, and radii where the margin is negative.

use super::Scene;
use super::layer_groups::LayerGroups;
use super::partners::{Partners, radii_may_meet, radius};
use crate::broad_phase::{Groups, PairFilter};
use crate::count::short;
use crate::id::BodyId;

/// The filter of pairs of slots: admits bodies that may be pairs within a margin.
pub(crate) struct PairAdmission<'s> {
    pub(crate) scene: &'s Scene,
    /// m.
    margin: f64,
    /// True if any two bodies may be a pair.
    admits_all: bool,
    groups: LayerGroups,
    /// Radii by slot, m, if they are [listed](Self::with_radii).
    radii: Vec<f64>,
    gives_up: &'s (dyn Fn() -> bool + Sync),
}

impl<'s> PairAdmission<'s> {
    /// Returns the filter of pairs within a margin (m), which gives up once `gives_up` returns true.
    pub(crate) fn of(
        scene: &'s Scene,
        margin: f64,
        gives_up: &'s (dyn Fn() -> bool + Sync),
    ) -> Self {
        let admits_all = scene.admits_all(margin);
        Self {
            scene,
            margin,
            admits_all,
            groups: if admits_all {
                LayerGroups::ONE
            } else {
                scene.kinds.layer_groups()
            },
            radii: Vec::new(),
            gives_up,
        }
    }

    /// Lists the radii if the margin asks for them, for whoever asks about most bodies: one that is not cached takes as
    /// long to fetch as many comparisons.
    pub(crate) fn with_radii(mut self) -> Self {
        if self.margin < 0.0 {
            let slots = 0..short(self.scene.slots());
            self.radii = slots.map(|slot| self.scene.radius(slot)).collect();
        }
        self
    }

    /// Returns true if the spheres of two bodies may be within the margin, which is negative.
    fn radii_may_meet(&self, a: u32, b: u32) -> bool {
        let radius = |slot: u32| {
            let listed = self.radii.get(slot as usize).copied();
            listed.unwrap_or_else(|| self.scene.radius(slot))
        };
        radii_may_meet(radius(a), radius(b), self.margin)
    }
}

impl PairFilter for PairAdmission<'_> {
    #[inline]
    fn admits(&self, a: u32, b: u32) -> bool {
        self.admits_all
            || self.scene.admits(a, b) && (self.margin >= 0.0 || self.radii_may_meet(a, b))
    }

    fn admits_all(&self) -> bool {
        self.admits_all
    }

    fn groups(&self) -> Groups {
        self.groups.groups
    }

    /// Returns the group of the body in a slot; the first one if there is no body.
    fn group(&self, slot: u32) -> u8 {
        if self.admits_all {
            return 0;
        }
        self.groups.of_layers(self.scene.layers[slot as usize])
    }

    fn gives_up(&self) -> bool {
        (self.gives_up)()
    }
}

impl Scene {
    /// Returns the test whether a body has a partner: another body with which it may be a pair within a margin (m).
    pub(crate) fn partners(&self, margin: f64) -> Partners<'_> {
        Partners::of(&self.kinds, margin)
    }

    /// Returns true if any two bodies may be a pair with a margin (m).
    pub(crate) fn admits_all(&self, margin: f64) -> bool {
        margin >= 0.0 && self.ignored.is_empty() && self.kinds.admit_all()
    }

    /// Returns true if the bodies of two slots may be a pair by layers and ignored pairs.
    fn admits(&self, a: u32, b: u32) -> bool {
        // Bodies are not fetched: one that is not cached takes as long as many comparisons.
        let [of_a, of_b] = [a, b].map(|slot| self.layers[slot as usize]);
        let are_ignored = || {
            let [one, other] = [a, b].map(|slot| self.keys[slot as usize].id(slot));
            self.ignores(one, other)
        };
        of_a.admits(of_b) && (self.ignored.is_empty() || !are_ignored())
    }

    /// Returns true if two bodies ignore each other.
    pub(crate) fn ignores(&self, a: BodyId, b: BodyId) -> bool {
        self.ignored.contains(a, b)
    }

    /// Returns the [`radius`] of the body in a slot, m; 0 if there is none.
    fn radius(&self, slot: u32) -> f64 {
        let entry = self.in_slot(slot);
        entry.map_or(0.0, |(_, entry)| radius(&entry.body))
    }
}
