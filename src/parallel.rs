//! Work on all threads of the current rayon pool, or on the caller's without the feature
//! `parallel`.

use std::cmp::Ordering;

/// Returns `work(scratch, index)` for each index below `count`, in index order, with one scratch
/// per thread. A single item stays on this thread: waking another one takes longer.
#[cfg(feature = "parallel")]
pub(crate) fn map<I, S, T>(
    count: I,
    scratch: impl Fn() -> S + Sync + Send,
    work: impl Fn(&mut S, I) -> T + Sync + Send,
) -> Vec<T>
where
    I: Copy + Default + Send,
    std::ops::Range<I>: Iterator<Item = I> + rayon::iter::IntoParallelIterator<Item = I>,
    <std::ops::Range<I> as rayon::iter::IntoParallelIterator>::Iter:
        rayon::iter::IndexedParallelIterator,
    T: Send,
{
    use rayon::iter::{IntoParallelIterator, ParallelIterator};
    let mut indices = I::default()..count;
    match (indices.next(), indices.next()) {
        (only, None) => only
            .into_iter()
            .map(|index| work(&mut scratch(), index))
            .collect(),
        _ => (I::default()..count)
            .into_par_iter()
            .map_init(scratch, work)
            .collect(),
    }
}

/// Returns `work(scratch, index)` for each index below `count`, in index order.
#[cfg(not(feature = "parallel"))]
pub(crate) fn map<I, S, T>(
    count: I,
    scratch: impl Fn() -> S,
    work: impl Fn(&mut S, I) -> T,
) -> Vec<T>
where
    I: Default,
    std::ops::Range<I>: Iterator<Item = I>,
{
    let mut scratch = scratch();
    (I::default()..count)
        .map(|index| work(&mut scratch, index))
        .collect()
}

/// Returns the values of consecutive shares of the indices below `count`, in index order. The value
/// of a share begins as `new()`, and `work(value, index)` adds each index. Up to `few` items make one
/// share, and so do all on one thread.
pub(crate) fn fold<T: Send>(
    count: usize,
    few: usize,
    new: impl Fn() -> T + Sync + Send,
    work: impl Fn(&mut T, usize) + Sync + Send,
) -> Vec<T> {
    #[cfg(feature = "parallel")]
    if count > few && threads() > 1 {
        use rayon::iter::{IntoParallelIterator, ParallelIterator};
        let shares = (0..count).into_par_iter().fold(&new, |mut value, index| {
            work(&mut value, index);
            value
        });
        return shares.collect();
    }
    #[cfg(not(feature = "parallel"))]
    let _ = few;
    let mut value = new();
    (0..count).for_each(|index| work(&mut value, index));
    vec![value]
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
    if count > few {
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
/// Several threads begin with the last chunks, so that increasing work ends evenly. If the `counted` work is at
/// most `few`, all stay on this thread.
pub(crate) fn for_each_chunk<T: Send>(
    items: &mut [T],
    size: usize,
    (counted, few): (usize, usize),
    work: impl Fn(usize, &mut [T]) + Sync + Send,
) {
    #[cfg(feature = "parallel")]
    {
        use rayon::iter::{IndexedParallelIterator, ParallelIterator};
        use rayon::slice::ParallelSliceMut;
        if counted > few && items.len() > size {
            let chunks = items.par_chunks_mut(size).enumerate().rev();
            chunks.for_each(|(number, chunk)| work(number, chunk));
            return;
        }
    }
    #[cfg(not(feature = "parallel"))]
    let _ = (counted, few);
    for (number, chunk) in items.chunks_mut(size).enumerate() {
        work(number, chunk);
    }
}

/// Calls `work(number, share, own)` for each share of `size` items of two lists of the same length, with a value
/// of its own. Two shares at least; fewer stay on this thread.
pub(crate) fn for_each_share<T: Send, U: Send, V: Send>(
    (one, other): (&mut [T], &mut [U]),
    own: &mut [V],
    size: usize,
    work: impl Fn(usize, (&mut [T], &mut [U]), &mut V) + Sync + Send,
) {
    #[cfg(feature = "parallel")]
    {
        use rayon::iter::{IndexedParallelIterator, IntoParallelRefMutIterator, ParallelIterator};
        use rayon::slice::ParallelSliceMut;
        if one.len() > size {
            let shares = one.par_chunks_mut(size).zip(other.par_chunks_mut(size));
            let shares = shares.zip(own.par_iter_mut()).enumerate();
            shares.for_each(|(number, (share, own))| work(number, share, own));
            return;
        }
    }
    let shares = one.chunks_mut(size).zip(other.chunks_mut(size));
    for (number, (share, own)) in shares.zip(own).enumerate() {
        work(number, share, own);
    }
}

/// Runs two functions in parallel, or one after the other for few items: see [`map`].
pub(crate) fn join<T: Send, U: Send>(
    count: usize,
    few: usize,
    one: impl FnOnce() -> T + Send,
    other: impl FnOnce() -> U + Send,
) -> (T, U) {
    #[cfg(feature = "parallel")]
    if count > few {
        return rayon::join(one, other);
    }
    #[cfg(not(feature = "parallel"))]
    let _ = (count, few);
    let other = other();
    (one(), other)
}

/// Sorts by a total order without ties that matter: the same on any number of threads.
pub(crate) fn sort<T: Send>(values: &mut [T], order: impl Fn(&T, &T) -> Ordering + Sync) {
    #[cfg(feature = "parallel")]
    {
        use rayon::slice::ParallelSliceMut;
        values.par_sort_by(order);
    }
    #[cfg(not(feature = "parallel"))]
    values.sort_by(order);
}
