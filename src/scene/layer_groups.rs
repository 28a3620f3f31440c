//! Groups of bodies by their layers: which of them may form pairs.

use crate::broad_phase::Groups;
use crate::layers::Layers;
use arrayvec::ArrayVec;

/// The layers of a scene's bodies, in groups. Layers that admit the same layers are of one group.
#[derive(Clone, Debug)]
pub(crate) struct LayerGroups {
    /// Different layers, each with its group.
    layers: ArrayVec<(Layers, u8), { Self::MANY }>,
    pub(crate) groups: Groups,
}

impl LayerGroups {
    /// Largest number of different layers that are put into groups.
    const MANY: usize = 64;

    /// All in one group: nothing is known of them.
    pub(crate) const ONE: Self = Self {
        layers: ArrayVec::new_const(),
        groups: Groups::ONE,
    };

    /// Returns the groups of different layers: one group if these are too many for [`Groups::MAX`].
    pub(super) fn of(different: impl ExactSizeIterator<Item = Layers> + Clone) -> Self {
        if !(1..=Self::MANY).contains(&different.len()) {
            return Self::ONE;
        }
        let admitted = |own: Layers| {
            let others = different.clone().enumerate();
            others.fold(0_u64, |bits, (number, other)| {
                bits | u64::from(own.admits(other)) << number
            })
        };
        let mut representatives = ArrayVec::<(Layers, u64), { Groups::MAX }>::new();
        let mut layers = ArrayVec::new();
        for own in different.clone() {
            let bits = admitted(own);
            let known = representatives.iter().position(|&(_, other)| other == bits);
            let group = known.unwrap_or(representatives.len());
            if known.is_none() && representatives.try_push((own, bits)).is_err() {
                return Self::ONE;
            }
            let Ok(group) = u8::try_from(group) else {
                return Self::ONE;
            };
            layers.push((own, group));
        }
        let admits =
            |one: usize, other: usize| representatives[one].0.admits(representatives[other].0);
        Self {
            layers,
            groups: Groups::new(representatives.len(), admits),
        }
    }

    /// Returns the group of a body with these layers.
    #[inline]
    pub(crate) fn of_layers(&self, layers: Layers) -> u8 {
        let known = self.layers.iter().find(|(other, _)| *other == layers);
        known.map_or(0, |&(_, group)| group)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two layers are of groups that admit each other exactly if the layers do.
    #[test]
    fn groups_admit_each_other_as_their_layers_do() {
        let few = [(1, 3), (2, 1), (4, 1), (8, 0), (16, 16), (3, 3)];
        let many = (0..20).map(|bit| (1 << bit, !(1 << bit)));
        for (layers, count) in [(few.to_vec(), 4), (many.collect(), 1)] {
            let layers: Vec<Layers> = layers
                .into_iter()
                .map(|(membership, filter)| Layers::new(membership, filter))
                .collect();
            let groups = LayerGroups::of(layers.iter().copied());
            assert_eq!(groups.groups.count(), count);
            for (one, other) in layers
                .iter()
                .flat_map(|one| layers.iter().map(move |other| (one, other)))
            {
                let of_both = [one, other].map(|own| usize::from(groups.of_layers(*own)));
                let admits = groups.groups.admits(of_both[0], of_both[1]);
                assert!(
                    admits == one.admits(*other) || count == 1,
                    "{one:?} {other:?}"
                );
            }
        }
    }
}
