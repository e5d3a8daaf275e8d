//! State that two threads share.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

#[derive(Default)]
pub struct Shared<T> {
    state: Mutex<T>,
    /// Whoever changes the state in a way that the other waits for says so here.
    pub changed: Condvar,
}

impl<T> Shared<T> {
    /// A thread that panicked has left the state as it stood between two changes.
    pub fn state(&self) -> MutexGuard<'_, T> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
