//! Rendering gives way to the window: on machines without a GPU both run on the same cores.

/// Lowers the calling thread's priority, and with it that of the threads it starts later (a software driver's among
/// them). Does nothing where the system has no such notion for threads.
pub(super) fn lower_thread_priority() {
    #[cfg(target_os = "linux")]
    {
        // SAFETY: no memory is touched. On Linux the call means the calling thread; it cannot fail for larger values.
        let _ = unsafe { libc::nice(10) };
    }
}

/// Makes the cores' worker threads, which all rendering on the processor uses, give way to the window. Only the first
/// call has an effect, and only before those threads are used.
pub fn let_rendering_give_way() {
    // Fails where the threads run already: then they keep their priority.
    let _ = rayon::ThreadPoolBuilder::new()
        .start_handler(|_| lower_thread_priority())
        .build_global();
}
