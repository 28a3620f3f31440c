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
    /// Largest number of excluded pairs for each body that are compared like others: in a crowd each may be a candidate.
    const FEW: f64 = 4.0;

    /// All in one group: nothing is known of them.
    pub(crate) const ONE: Self = Self {
        layers: ArrayVec::new_const(),
        groups: Groups::ONE,
    };

    /// Returns the groups of different layers, each with the number of its bodies: one group if these are too many for
    /// [`Groups::MAX`], or if groups would leave out few pairs.
    pub(super) fn of(different: impl ExactSizeIterator<Item = (Layers, usize)> + Clone) -> Self {
        if different.len() > Self::MANY || Self::leave_out_few(different.clone()) {
            return Self::ONE;
        }
        let admitted = |own: Layers| {
            let others = different.clone().enumerate();
            others.fold(0_u64, |bits, (number, (other, _))| {
                bits | u64::from(own.admits(other)) << number
            })
        };
        let mut representatives = ArrayVec::<(Layers, u64), { Groups::MAX }>::new();
        let mut layers = ArrayVec::new();
        for (own, _) in different.clone() {
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
        let admits = |one: usize, other: usize| {
            let (Some((one, _)), Some((other, _))) =
                (representatives.get(one), representatives.get(other))
            else {
                return false;
            };
            one.admits(*other)
        };
        Self {
            layers,
            groups: Groups::new(representatives.len(), admits),
        }
    }

    /// Returns true if different layers exclude so few pairs of bodies that comparing these costs less than groups do.
    fn leave_out_few(different: impl Iterator<Item = (Layers, usize)> + Clone) -> bool {
        let mut kinds = different.map(|(layers, count)| (layers, count as f64));
        let (mut bodies, mut excluded) = (0.0, 0.0);
        while let Some((own, count)) = kinds.next() {
            bodies += count;
            if !own.admits(own) {
                excluded += 0.5 * count * (count - 1.0);
            }
            let others = kinds.clone().filter(|(other, _)| !own.admits(*other));
            excluded += count * others.map(|(_, count)| count).sum::<f64>();
        }
        excluded <= Self::FEW * bodies
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

    /// At most four for each body.
    #[test]
    fn groups_that_leave_out_few_pairs_are_not_made() {
        let (one, other) = (Layers::new(1, 2), Layers::new(2, 3));
        for (count, groups) in [(1, 1), (33, 1), (34, 2), (100, 2)] {
            let of_both = [(one, count), (other, 100)];
            let found = LayerGroups::of(of_both.into_iter());
            assert_eq!(found.groups.count(), groups, "{count}");
        }
        // One that meets nobody, and one that meets itself alone.
        for alone in [Layers::NONE, Layers::new(4, 4)] {
            let found = LayerGroups::of([(alone, 1), (other, 100)].into_iter());
            assert_eq!(found.groups.count(), 1);
        }
    }

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
            let groups = LayerGroups::of(layers.iter().map(|&layers| (layers, 100)));
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
