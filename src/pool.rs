//! Buffers that one run leaves to the next.

use std::fmt;
use std::ops::{Deref, DerefMut};
use std::sync::{Mutex, PoisonError};

/// Scratch that waits for its next use: first use of fresh memory costs as much as writing its content.
#[derive(Default)]
pub(crate) struct Pool<T> {
    /// By address: scratch is large, and taken for single bodies.
    unused: Mutex<Vec<Box<T>>>,
}

impl<T: Default> Pool<T> {
    /// Returns scratch from the pool, to which it returns when dropped.
    pub(crate) fn take(&self) -> Pooled<'_, T> {
        let unused = self.unused.lock();
        // The lock ends with this statement: new scratch is made without it.
        let scratch = unused.unwrap_or_else(PoisonError::into_inner).pop();
        Pooled {
            scratch: Some(scratch.unwrap_or_default()),
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
    /// `None` once it went back.
    scratch: Option<Box<T>>,
    pool: &'p Pool<T>,
}

impl<T: Default> Deref for Pooled<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.scratch.as_deref().unwrap_or_else(|| gone())
    }
}

impl<T: Default> DerefMut for Pooled<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        self.scratch.as_deref_mut().unwrap_or_else(|| gone())
    }
}

impl<T: Default> Drop for Pooled<'_, T> {
    fn drop(&mut self) {
        let unused = self.pool.unused.lock();
        let mut unused = unused.unwrap_or_else(PoisonError::into_inner);
        unused.extend(self.scratch.take());
    }
}

/// Scratch is there until it is dropped.
#[cold]
fn gone() -> ! {
    unreachable!("scratch goes back when dropped")
}
