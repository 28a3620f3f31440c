//! Membership and filter masks of bodies.

/// Membership and filter bit masks, as in rapier's `InteractionGroups`.
///
/// Two bodies are a pair if each is a member of a layer that the other filters for. Where bodies crowd, others are not
/// compared with each other, if the layers of a scene make at most eight groups: bodies that meet the same layers are of
/// one group.
///
/// ```
/// use nearmiss::Layers;
///
/// const DRONES: u32 = 1;
/// const BUILDINGS: u32 = 2;
/// let drone = Layers::new(DRONES, DRONES | BUILDINGS);
/// let building = Layers::new(BUILDINGS, DRONES);
/// assert!(drone.admits(drone) && drone.admits(building));
/// assert!(!building.admits(building));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Layers {
    /// The layers that the body belongs to, one bit each.
    pub membership: u32,
    /// The layers whose members the body is screened against, one bit each.
    pub filter: u32,
}

impl Layers {
    /// Member of all layers, screened against all: the default.
    pub const ALL: Self = Self {
        membership: u32::MAX,
        filter: u32::MAX,
    };

    /// Member of no layer: never part of a pair.
    pub const NONE: Self = Self {
        membership: 0,
        filter: 0,
    };

    /// Returns layers with these two masks.
    #[must_use]
    pub const fn new(membership: u32, filter: u32) -> Self {
        Self { membership, filter }
    }

    /// Returns true if bodies with these layers are a pair, in either order.
    #[must_use]
    pub const fn admits(self, other: Self) -> bool {
        self.membership & other.filter != 0 && other.membership & self.filter != 0
    }
}

impl Default for Layers {
    fn default() -> Self {
        Self::ALL
    }
}
