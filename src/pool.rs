//! Buffers that one run leaves to the next.

use std::fmt;
use std::ops::{Deref, DerefMut};
use std::sync::{Mutex, PoisonError};

/// Scratch that waits for its next use: first use of fresh memory costs as much as writing its content.
#[derive(Default)]
pub(crate) struct Pool<T> {
    unused: Mutex<Vec<OneBoxed<T>>>,
}

/// A list of one, by its address: scratch is large, and taken for single bodies. An empty list takes no memory.
type OneBoxed<T> = Box<[T]>;

impl<T: Default> Pool<T> {
    /// Returns scratch from the pool, to which it returns when dropped.
    pub(crate) fn take(&self) -> Pooled<'_, T> {
        let unused = self.unused.lock().unwrap_or_else(PoisonError::into_inner);
        let unused = { unused }.pop();
        Pooled {
            scratch: unused.unwrap_or_else(|| Box::new([T::default()])),
            pool: self,
        }
    }
}

impl<T: Default> Clone for Pool<T> {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl<T> fmt::Debug for Pool<T> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Pool").finish_non_exhaustive()
    }
}

/// Scratch on loan from a pool.
#[derive(Debug)]
pub(crate) struct Pooled<'p, T: Default> {
    scratch: OneBoxed<T>,
    pool: &'p Pool<T>,
}

impl<T: Default> Deref for Pooled<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.scratch[0]
    }
}

impl<T: Default> DerefMut for Pooled<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        &mut self.scratch[0]
    }
}

impl<T: Default> Drop for Pooled<'_, T> {
    fn drop(&mut self) {
        let scratch = std::mem::take(&mut self.scratch);
        let unused = self.pool.unused.lock();
        unused.unwrap_or_else(PoisonError::into_inner).push(scratch);
    }
}
