//! Where tables lie in memory that paths look up anywhere in, and asking for them ahead of their use.

/// What a processor finds the place of in one step at best.
#[cfg(target_os = "linux")]
const LARGE_PAGE: usize = 2 << 20;

/// Room for so many elements, in large pages of memory where the system has them. What is not used of it takes none.
pub(super) fn room_in_large_pages<E>(count: usize) -> Vec<E> {
    let elements: Vec<E> = Vec::with_capacity(count);
    #[cfg(target_os = "linux")]
    if count * size_of::<E>() >= 2 * LARGE_PAGE {
        advise(elements.as_ptr().cast(), count * size_of::<E>(), &[libc::MADV_HUGEPAGE]);
    }
    elements
}

/// The same elements, in large pages of memory where the system has them: else finding the place of each costs a processor
/// more than reading it. They are not copied by us, so that nothing is there twice.
pub(super) fn in_large_pages<E>(elements: Vec<E>) -> Vec<E> {
    #[cfg(target_os = "linux")]
    if size_of_val(&elements[..]) >= 2 * LARGE_PAGE {
        // MADV_COLLAPSE, which not every libc names: at once, since Linux 6.1.
        const COLLAPSE: libc::c_int = 25;
        let advices = [libc::MADV_HUGEPAGE, COLLAPSE];
        advise(elements.as_ptr().cast(), size_of_val(&elements[..]), &advices);
    }
    elements
}

/// Tells the system how memory that was allocated is to be kept.
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

/// What a processor fetches at once.
#[cfg(target_arch = "x86_64")]
const LINE: usize = 64;

/// Has the processor fetch an element, where it knows how to; what is computed does not depend on it.
#[inline(always)]
pub(super) fn prefetch<E>(elements: &[E], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if let Some(element) = elements.get(index) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let start: *const i8 = std::ptr::from_ref(element).cast();
        for line in (0..size_of::<E>()).step_by(LINE) {
            // SAFETY: the place is in the element; nothing is read that the program could tell.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(start.add(line)) };
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (elements, index);
}
