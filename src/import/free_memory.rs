//! Free memory of the process, and the user's limit.

use sysinfo::{MemoryRefreshKind, RefreshKind, System};

/// Environment variable with the memory limit of a render and its imports, in MiB.
pub const LIMIT_VARIABLE: &str = "GLOSSMITH_MEMORY";
/// Share of the free memory that a render may use: other parts and programs need the rest.
const SHARE: f64 = 0.9;
/// Share of that for the files of one import: the scene is built from them, and the render follows.
const IMPORT_SHARE: f64 = 0.5;

/// The bytes that [`LIMIT_VARIABLE`] names.
pub fn limit() -> Option<u64> {
    let mib: u64 = std::env::var(LIMIT_VARIABLE).ok()?.trim().parse().ok()?;
    Some(mib.saturating_mul(1 << 20))
}

/// The bytes that the files of one import may take.
pub(super) fn of_import() -> u64 {
    limit().unwrap_or_else(|| (IMPORT_SHARE * free(0) as f64) as u64)
}

/// Remaining bytes of the process's limit, if any (`ulimit -v`).
#[cfg(target_os = "linux")]
fn of_process() -> u64 {
    let mut limit = libc::rlimit {
        rlim_cur: 0,
        rlim_max: 0,
    };
    // SAFETY: it writes into the given struct.
    let is_known = unsafe { libc::getrlimit(libc::RLIMIT_AS, &raw mut limit) } == 0;
    if !is_known || limit.rlim_cur == libc::RLIM_INFINITY {
        return u64::MAX;
    }
    let sizes = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let taken_kib = sizes.lines().find_map(|line| {
        line.strip_prefix("VmSize:")?
            .trim()
            .strip_suffix(" kB")?
            .parse::<u64>()
            .ok()
    });
    // At least 1, because 0 means unknown.
    limit.rlim_cur.saturating_sub(taken_kib.unwrap_or(0) << 10).max(1)
}

/// Other systems have no such limit.
#[cfg(not(target_os = "linux"))]
fn of_process() -> u64 {
    u64::MAX
}

/// Default memory of a render in bytes. `held` is memory that is freed when it starts.
pub fn free(held: u64) -> u64 {
    let ram = MemoryRefreshKind::nothing().with_ram();
    let Ok(system) = System::new_with_specifics(RefreshKind::nothing().with_memory(ram)) else {
        return u64::MAX;
    };
    // A container may have less than the machine.
    let of_container = system.cgroup_limits().map_or(u64::MAX, |limits| limits.free_memory);
    match system.available_memory().min(of_container).min(of_process()) {
        // The system does not say.
        0 => u64::MAX,
        free => (SHARE * free.saturating_add(held) as f64) as u64,
    }
}
