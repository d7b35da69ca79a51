//! Parallel loops, all through one function that is not generic: a loop of rayon's is some 6700 lines of LLVM code each.

use std::{ops::Range, sync::Mutex, sync::PoisonError};

use rayon::prelude::*;

/// The most items of a block: few enough for a cache, enough that a call per block is not seen.
const BLOCK_MAX: usize = 4096;
/// Blocks for each thread, so that uneven ones even out.
const BLOCKS_PER_THREAD: usize = 16;

/// Does `work` for ranges that cover `0..count` without overlap, of `block` items each but for the last, on all cores.
pub fn for_blocks(count: usize, block: usize, work: &(dyn Fn(Range<usize>) + Sync)) {
    let blocks = (0..count.div_ceil(block)).into_par_iter();
    blocks.for_each(|index| work(index * block..((index + 1) * block).min(count)));
}

fn block_of(count: usize) -> usize {
    let blocks = BLOCKS_PER_THREAD * rayon::current_num_threads();
    count.div_ceil(blocks).clamp(1, BLOCK_MAX)
}

/// A place in memory that every thread may write to.
struct Shared<T>(*mut T);

// SAFETY: no two blocks have an index in common, so no two threads write to the same place.
unsafe impl<T: Send> Sync for Shared<T> {}

impl<T> Shared<T> {
    fn at(&self, index: usize) -> *mut T {
        // SAFETY: callers pass indices within the allocation.
        unsafe { self.0.add(index) }
    }
}

/// The values of a function of 0 to `count` − 1, in that order.
pub fn map<R: Send>(count: usize, of: impl Fn(usize) -> R + Sync) -> Vec<R> {
    let mut results = Vec::<R>::with_capacity(count);
    let first = Shared(results.as_mut_ptr());
    for_blocks(count, block_of(count), &|range| {
        for index in range {
            // SAFETY: there is room for `count` values. After a panic those that were written are not dropped.
            unsafe { first.at(index).write(of(index)) };
        }
    });
    // SAFETY: all of them were written.
    unsafe { results.set_len(count) };
    results
}

/// The values of a function of each item, in the items' order.
pub fn map_each<T: Sync, R: Send>(items: &[T], of: impl Fn(&T) -> R + Sync) -> Vec<R> {
    map(items.len(), |index| of(&items[index]))
}

/// The values of a function that takes each item, in the items' order.
pub fn map_into<T: Send, R: Send>(items: Vec<T>, of: impl Fn(T) -> R + Sync) -> Vec<R> {
    let items: Vec<_> = items.into_iter().map(|item| Mutex::new(Some(item))).collect();
    let taken = |item: &Mutex<Option<T>>| item.lock().unwrap_or_else(PoisonError::into_inner).take();
    map(items.len(), |index| {
        of(taken(&items[index]).expect("each is taken once"))
    })
}

/// The values of a function of blocks of at most 4096 indices, in their order: the same blocks on every machine, so that
/// sums over them have the same bits.
pub fn map_blocks<R: Send>(count: usize, of: impl Fn(Range<usize>) -> R + Sync) -> Vec<R> {
    let range = |block: usize| block * BLOCK_MAX..((block + 1) * BLOCK_MAX).min(count);
    map(count.div_ceil(BLOCK_MAX), |block| of(range(block)))
}

/// Does `work` for each whole row of `width` values, with its number.
pub fn for_rows<T: Send>(values: &mut [T], width: usize, work: impl Fn(usize, &mut [T]) + Sync) {
    let width = width.max(1);
    let rows = values.len() / width;
    let first = Shared(values.as_mut_ptr());
    for_blocks(rows, block_of(rows), &|range| {
        for row in range {
            // SAFETY: rows do not overlap and lie within `values`, which is borrowed until all are done.
            work(row, unsafe {
                std::slice::from_raw_parts_mut(first.at(row * width), width)
            });
        }
    });
}
