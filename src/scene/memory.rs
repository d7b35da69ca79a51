//! Memory of tables with random access: large pages and prefetching.

/// Size of a large page, in bytes.
#[cfg(target_os = "linux")]
const LARGE_PAGE: usize = 2 << 20;

/// A vector with capacity `count`, in large pages if the system has them. Unused room takes no memory.
pub fn room_in_large_pages<E>(count: usize) -> Vec<E> {
    let elements: Vec<E> = Vec::with_capacity(count);
    #[cfg(target_os = "linux")]
    if count * size_of::<E>() >= 2 * LARGE_PAGE {
        advise(elements.as_ptr().cast(), count * size_of::<E>(), &[libc::MADV_HUGEPAGE]);
    }
    elements
}

/// The same elements in large pages, if the system has them: otherwise a CPU's address translation costs more than the read.
/// The system moves them in place, without a copy.
pub fn in_large_pages<E>(elements: Vec<E>) -> Vec<E> {
    #[cfg(target_os = "linux")]
    if size_of_val(&elements[..]) >= 2 * LARGE_PAGE {
        // MADV_COLLAPSE, which not every libc names: at once, since Linux 6.1.
        const COLLAPSE: libc::c_int = 25;
        let advices = [libc::MADV_HUGEPAGE, COLLAPSE];
        advise(elements.as_ptr().cast(), size_of_val(&elements[..]), &advices);
    }
    elements
}

/// Advises the system how to keep an allocation.
#[cfg(target_os = "linux")]
fn advise(place: *const u8, bytes: usize, advices: &[libc::c_int]) {
    const PAGE: usize = 4096;
    let before = place.align_offset(PAGE);
    let start = place.wrapping_add(before).cast_mut().cast();
    let length = bytes.saturating_sub(before) / PAGE * PAGE;
    for &advice in advices {
        // SAFETY: whole pages inside of what was allocated; how they are kept changes nothing of what is in them. That a
        // system does not know the advice does no harm.
        unsafe { libc::madvise(start, length, advice) };
    }
}

/// Size of a cache line, in bytes.
#[cfg(target_arch = "x86_64")]
const LINE: usize = 64;

/// Prefetches an element into the cache, if the CPU supports it. Results do not depend on it.
#[inline(always)]
pub fn prefetch<E>(elements: &[E], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if let Some(element) = elements.get(index) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let start: *const i8 = std::ptr::from_ref(element).cast();
        for line in (0..size_of::<E>()).step_by(LINE) {
            // SAFETY: the address is within the element, and prefetching has no observable effect.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(start.add(line)) };
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (elements, index);
}
