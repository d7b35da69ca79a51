//! Rendering gives way to the window: on machines without a GPU both run on the same cores.

/// The niceness of threads that render, and of those that compute beside them.
const NICENESS: i32 = 10;
const APART: i32 = 19;

/// Lowers the calling thread's priority, and with it that of the threads it starts later (a software driver's and the
/// denoiser's among them). Once: what was lowered already stays as it is, so that threads which a lowered one starts are
/// not starved by it. Does nothing where the system has no such notion for threads.
pub(super) fn lower_thread_priority() {
    lower_to(NICENESS);
}

fn lower_to(niceness: i32) {
    #[cfg(target_os = "linux")]
    {
        // SAFETY: no memory is touched. On Linux 0 means the calling thread; larger values are never refused.
        unsafe {
            if libc::getpriority(libc::PRIO_PROCESS, 0) < niceness {
                libc::setpriority(libc::PRIO_PROCESS, 0, niceness);
            }
        }
    }
    #[cfg(not(target_os = "linux"))]
    let _ = niceness;
}

/// Has what this thread computes in parallel run on threads of its own from now on, half as many as there are cores,
/// which give way to those that render: on the common ones it would hold up pictures and loading.
pub fn work_apart() {
    if rayon::current_thread_index().is_some() {
        return;
    }
    lower_to(APART);
    let threads = (rayon::current_num_threads() / 2).max(1);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .use_current_thread();
    match pool.build() {
        // It lasts as long as the thread.
        Ok(pool) => std::mem::forget(pool),
        Err(error) => log::warn!("what is computed beside the window holds up rendering: {error}"),
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

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn threads_of_lowered_threads_are_lowered_no_further() {
        // SAFETY: no memory is touched.
        let niceness = || unsafe { libc::getpriority(libc::PRIO_PROCESS, 0) };
        let begun_with = niceness();
        let lowered_twice = std::thread::spawn(move || {
            lower_thread_priority();
            let inner = std::thread::spawn(move || {
                lower_thread_priority();
                niceness()
            });
            inner.join().expect("it does not panic")
        });
        let wanted = begun_with.max(NICENESS);
        assert_eq!(lowered_twice.join().expect("it does not panic"), wanted);
    }
}
