//! Rendering gives way to the window: on machines without a GPU both run on the same cores.

/// Niceness of rendering threads and of background threads.
const NICENESS: i32 = 10;
const APART: i32 = 19;

/// Lowers the priority of the calling thread and of threads that it starts later (among them a software driver's and the
/// denoiser's). Only once: threads of a lowered one are not lowered again. No effect if the system has no thread priorities.
pub fn lower_thread_priority() {
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

/// Runs this thread's parallel work on its own pool from now on, with half as many threads as cores and low priority: on the
/// common pool it would delay renders and loading.
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
        // The pool lasts as long as the thread.
        Ok(pool) => std::mem::forget(pool),
        Err(error) => log::warn!("what is computed beside the window holds up rendering: {error}"),
    }
}

/// Creates the common pool with lowered priority, so that CPU rendering yields to the window. Only the first call has an
/// effect, before the pool is used.
pub fn let_rendering_give_way() {
    // Fails if the pool exists already: then it keeps its priority.
    let _ = rayon::ThreadPoolBuilder::new()
        .start_handler(|_| lower_thread_priority())
        .build_global();
}
