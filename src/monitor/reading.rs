//! What pairs have at one alert level, whatever the window, and which of it lies in one.

use super::finds::Pair;
use super::kept::{Entry, Kept};
use crate::conflict::Conflict;

/// Two bodies, the smaller slot first.
pub(super) type Slots = (u32, u32);

/// What pairs have at one level.
#[derive(Debug)]
pub(super) struct Reading<T> {
    /// Whatever the window.
    pub(super) always: Kept<Slots, T>,
    /// Of pairs at an edge of the window, as this tick sees them.
    at_edge: Vec<T>,
    /// What this tick has: when it begins (s), and where it is.
    listed: Vec<(f64, Origin)>,
}

impl<T> Default for Reading<T> {
    fn default() -> Self {
        Self {
            always: Kept::default(),
            at_edge: Vec::new(),
            listed: Vec::new(),
        }
    }
}

#[derive(Clone, Copy, Debug)]
enum Origin {
    Always(usize),
    AtEdge(usize),
}

/// How a contact lies to a window.
#[derive(PartialEq)]
enum Place {
    Within,
    Beyond,
    AtEdge,
}

impl Place {
    /// `within` is open, `around` closed.
    fn of((start, end): (f64, f64), within: (f64, f64), around: (f64, f64)) -> Self {
        if start > within.0 && end < within.1 {
            Self::Within
        } else if end < around.0 || start > around.1 {
            Self::Beyond
        } else {
            Self::AtEdge
        }
    }
}

impl<T> Reading<T> {
    /// Drops what is of pairs that are gone, or are to be read anew.
    pub(super) fn keep_unchanged(&mut self, pairs: &[Pair]) {
        let mut rest = pairs.iter().peekable();
        self.always.retain(|entry| {
            while rest.next_if(|pair| pair.slots < entry.key).is_some() {}
            let pair = rest.peek();
            pair.is_some_and(|pair| pair.slots == entry.key && !pair.is_new)
        });
    }

    /// Lists what lies in a window, in the order of the pairs. Of those with something at its edge,
    /// all is read again. See [`Place::of`].
    pub(super) fn read(
        &mut self,
        (within, around): ((f64, f64), (f64, f64)),
        begin: impl Fn(&T) -> f64,
        mut again: impl FnMut(Slots, &mut Vec<T>),
    ) {
        self.at_edge.clear();
        self.listed.clear();
        let place = |entry: &Entry<Slots>| Place::of(entry.interval, within, around);
        let entries = self.always.entries();
        for pair in entries.chunk_by(|x, y| x.key == y.key) {
            if pair.iter().any(|entry| place(entry) == Place::AtEdge) {
                let first = self.at_edge.len();
                again(pair[0].key, &mut self.at_edge);
                let read = (first..).zip(&self.at_edge[first..]);
                self.listed
                    .extend(read.map(|(number, one)| (begin(one), Origin::AtEdge(number))));
            } else {
                let found = pair.iter().filter(|entry| place(entry) == Place::Within);
                self.listed
                    .extend(found.map(|entry| (entry.interval.0, Origin::Always(entry.place))));
            }
        }
    }

    /// What was read last.
    pub(super) fn iter(&self) -> impl Iterator<Item = &T> {
        let Self {
            always, at_edge, ..
        } = self;
        self.listed
            .iter()
            .map(|(_, origin)| origin.of(always, at_edge))
    }
}

impl Reading<Conflict> {
    /// Sorts what was read last as it is reported. Only what is short moves.
    pub(super) fn sort(&mut self) {
        let Self {
            always,
            at_edge,
            listed,
        } = self;
        let ties = |x: &Origin, y: &Origin| x.of(always, at_edge).order(y.of(always, at_edge));
        listed.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then_with(|| ties(&x.1, &y.1)));
    }
}

impl Origin {
    fn of<'r, T>(&self, always: &'r Kept<Slots, T>, at_edge: &'r [T]) -> &'r T {
        match *self {
            Self::Always(place) => always.at(place),
            Self::AtEdge(number) => &at_edge[number],
        }
    }
}
