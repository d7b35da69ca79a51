//! A choice that holds for the whole process.

use std::marker::PhantomData;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use crate::named::Named;

/// The latest choice of one of a closed list, by its place in the list.
pub(in crate::render) struct Chosen<C> {
    place: AtomicUsize,
    of: PhantomData<C>,
}

impl<C: Named> Chosen<C> {
    /// The first of the list.
    pub const fn first() -> Self {
        Self {
            place: AtomicUsize::new(0),
            of: PhantomData,
        }
    }

    /// Holds from now on.
    pub fn set(&self, choice: C) {
        let place = C::ALL.iter().position(|other| *other == choice);
        self.place.store(place.unwrap_or_default(), Relaxed);
    }

    pub fn get(&self) -> C {
        C::ALL[self.place.load(Relaxed)]
    }
}
