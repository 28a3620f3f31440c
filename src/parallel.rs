//! Work on all threads of the current rayon pool, or on the caller's without the feature
//! `parallel`.
//!
//! A thread in no pool does not ask a global pool of one thread: that one may be busy elsewhere, as a main thread that is
//! the pool's own is while it waits for a live monitor.
//!
//! Work that [`Divide`] divides meets rayon in [`run_both`], which is compiled once. Rayon's iterators are compiled
//! anew for each closure: with them the crate had a fifth more code to compile. Three functions call rayon themselves:
//! [`map_into`] and [`sort`] have one caller each, and write into memory that is there; [`join`] divides nothing.

use std::cmp::Ordering;
use std::ops::Range;

/// Work that can be divided.
#[cfg_attr(
    not(feature = "parallel"),
    allow(dead_code, reason = "one thread does all")
)]
trait Divide: Sized + Send {
    /// The last parts are begun first, so that increasing work ends evenly.
    const LAST_FIRST: bool = false;

    /// Returns the number of parts that it can be divided into.
    fn count(&self) -> usize;

    /// Returns the parts before `middle`, and the others.
    fn divide(self, middle: usize) -> (Self, Self);
}

impl Divide for Range<usize> {
    fn count(&self) -> usize {
        self.len()
    }

    fn divide(self, middle: usize) -> (Self, Self) {
        let middle = self.start + middle;
        (self.start..middle, middle..self.end)
    }
}

/// Chunks of items; the last may have fewer.
#[cfg_attr(
    not(feature = "parallel"),
    allow(dead_code, reason = "one thread does all")
)]
struct Chunks<'a, T> {
    items: &'a mut [T],
    size: usize,
}

impl<T: Send> Divide for Chunks<'_, T> {
    const LAST_FIRST: bool = true;

    fn count(&self) -> usize {
        self.items.len().div_ceil(self.size)
    }

    fn divide(self, middle: usize) -> (Self, Self) {
        let size = self.size;
        let (items, others) = self.items.split_at_mut(middle * size);
        let others = Self {
            items: others,
            size,
        };
        (Self { items, size }, others)
    }
}

/// Returns true if this thread does all: it is in no pool, and its work would wait for the only thread of the global one.
#[cfg(feature = "parallel")]
fn is_alone() -> bool {
    threads() == 1 && rayon::current_thread_index().is_none()
}

/// Runs two tasks, on two threads if another one has time. A task is told whether another thread took
/// it over.
#[cfg(feature = "parallel")]
pub(crate) fn run_both(one: &mut (dyn FnMut(bool) + Send), other: &mut (dyn FnMut(bool) + Send)) {
    if is_alone() {
        one(false);
        other(false);
        return;
    }
    rayon::join_context(
        |context| one(context.migrated()),
        |context| other(context.migrated()),
    );
}

/// Divides work among the threads, and returns the results of its shares in order. `first` is the number
/// of its first part.
///
/// There are some shares for each thread. One that takes a share over from another divides it again: it has
/// nothing else to do.
#[cfg(feature = "parallel")]
fn share_out<W: Divide, T: Send>(
    work: W,
    first: usize,
    (divisions, is_taken_over): (usize, bool),
    task: &(dyn Fn(usize, W) -> T + Sync),
) -> Vec<T> {
    let divisions = if is_taken_over {
        threads().max(divisions)
    } else {
        divisions
    };
    let middle = work.count() / 2;
    if middle == 0 || divisions == 0 {
        return vec![task(first, work)];
    }
    let (before, after) = work.divide(middle);
    let (mut before, mut after) = (Some(before), Some(after));
    let (mut results, mut later) = (Vec::new(), Vec::new());
    let half = divisions / 2;
    let mut first_half = |is_taken_over| {
        if let Some(before) = before.take() {
            results = share_out(before, first, (half, is_taken_over), task);
        }
    };
    let mut second_half = |is_taken_over| {
        if let Some(after) = after.take() {
            later = share_out(after, first + middle, (half, is_taken_over), task);
        }
    };
    if W::LAST_FIRST {
        run_both(&mut second_half, &mut first_half);
    } else {
        run_both(&mut first_half, &mut second_half);
    }
    results.append(&mut later);
    results
}

/// Divides work among the threads, or does it on this one.
fn run<W: Divide, T: Send>(
    work: W,
    is_shared: bool,
    task: impl Fn(usize, W) -> T + Sync,
) -> Vec<T> {
    #[cfg(feature = "parallel")]
    if is_shared {
        return share_out(work, 0, (threads(), false), &task);
    }
    #[cfg(not(feature = "parallel"))]
    let _ = is_shared;
    vec![task(0, work)]
}

/// Returns `work(scratch, index)` for each index below `count`, in index order, with one scratch
/// per share. A single item stays on this thread: waking another one takes longer.
pub(crate) fn map<S, T: Send>(
    count: usize,
    scratch: impl Fn() -> S + Sync,
    work: impl Fn(&mut S, usize) -> T + Sync,
) -> Vec<T> {
    let shares = run(0..count, count > 1, |_, indices| {
        let mut scratch = scratch();
        let results = indices.map(|index| work(&mut scratch, index));
        results.collect::<Vec<T>>()
    });
    shares.into_iter().flatten().collect()
}

/// Returns the values of consecutive shares of the indices below `count`, in index order. The value
/// of a share begins as `new()`, and `work(value, index)` adds each index. Up to `few` items make one
/// share, and so do all on one thread.
pub(crate) fn fold<T: Send>(
    count: usize,
    few: usize,
    new: impl Fn() -> T + Sync,
    work: impl Fn(&mut T, usize) + Sync,
) -> Vec<T> {
    run(0..count, count > few && threads() > 1, |_, indices| {
        let mut value = new();
        indices.for_each(|index| work(&mut value, index));
        value
    })
}

/// Replaces the content of a list by `work(index)` for each index below `count`. Up to `few` are
/// computed on this thread.
pub(crate) fn map_into<T: Send>(
    count: usize,
    few: usize,
    list: &mut Vec<T>,
    work: impl Fn(usize) -> T + Sync + Send,
) {
    #[cfg(feature = "parallel")]
    if count > few && !is_alone() {
        use rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};
        (0..count).into_par_iter().map(work).collect_into_vec(list);
        return;
    }
    #[cfg(not(feature = "parallel"))]
    let _ = few;
    list.clear();
    list.extend((0..count).map(work));
}

/// Returns the number of threads that share work.
pub(crate) fn threads() -> usize {
    #[cfg(feature = "parallel")]
    return rayon::current_num_threads();
    #[cfg(not(feature = "parallel"))]
    1
}

/// Calls `work(number, chunk)` for each chunk of `size` items (the last may have fewer), chunks numbered from 0.
/// If the `counted` work is at most `few`, all stay on this thread.
pub(crate) fn for_each_chunk<T: Send>(
    items: &mut [T],
    size: usize,
    (counted, few): (usize, usize),
    work: impl Fn(usize, &mut [T]) + Sync,
) {
    let is_shared = counted > few && items.len() > size;
    run(Chunks { items, size }, is_shared, |first, chunks| {
        let chunks = chunks.items.chunks_mut(size).enumerate();
        chunks.for_each(|(number, chunk)| work(first + number, chunk));
    });
}

/// Calls `work(number, share)` for each share of work that was divided beforehand, shares numbered from 0.
pub(crate) fn for_each<T: Send>(shares: &mut [T], work: impl Fn(usize, &mut T) + Sync) {
    for_each_chunk(shares, 1, (1, 0), |number, share| {
        work(number, &mut share[0])
    });
}

/// Runs two functions in parallel. For few items, or on one thread, they run one after the other on this thread, in the
/// order given: waking another thread takes longer.
pub(crate) fn join<T: Send, U: Send>(
    count: usize,
    few: usize,
    one: impl FnOnce() -> T + Send,
    other: impl FnOnce() -> U + Send,
) -> (T, U) {
    #[cfg(feature = "parallel")]
    if count > few && !is_alone() {
        return rayon::join(one, other);
    }
    #[cfg(not(feature = "parallel"))]
    let _ = (count, few);
    (one(), other())
}

/// Sorts by a total order without ties that matter: the same on any number of threads.
pub(crate) fn sort<T: Send>(values: &mut [T], order: impl Fn(&T, &T) -> Ordering + Sync) {
    #[cfg(feature = "parallel")]
    if !is_alone() {
        use rayon::slice::ParallelSliceMut;
        values.par_sort_by(order);
        return;
    }
    values.sort_by(order);
}
