//! Compile time of a kernel, with empty caches and from the driver's cache.
//!
//! Drivers keep compiled kernels in memory and on disk. So each measurement is a process of its own, whose caches lie in a
//! folder that is empty at first.

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use tempfile::TempDir;

use super::report::EngineReport;
use super::{Done, Place, Run, StepTime, default_scene};
use crate::gpu::{GpuAdapter, Traversal};
use crate::render::Session;
use crate::study::StudyError;

/// Pairs of a process with empty caches and one that finds what the first left.
const PAIRS: usize = 3;
/// Unit of the rows; less is better.
const SECONDS: (&str, bool) = ("s", false);
/// Side of the image in pixels.
const SIZE: u32 = 16;
/// Variables that name the folder of a cache: ours and Mesa's default, Mesa's, NVIDIA's.
const FOLDERS: [&str; 3] = ["XDG_CACHE_HOME", "MESA_SHADER_CACHE_DIR", "__GL_SHADER_DISK_CACHE_PATH"];

/// Measures the compile times in child processes.
pub(super) fn kernels(run: &mut Run<'_, '_>, place: &Place, report: &mut EngineReport, slot: StepTime) -> Done {
    let Place::Adapter(adapter) = place else {
        return Ok(());
    };
    let Some(program) = &run.options.program else {
        report.leave_out(
            "kernel",
            "",
            "only the command glossmith benchmark compiles in processes of its own",
        );
        return Ok(());
    };
    let mut seconds = [const { Vec::new() }; 2];
    for pair in 0..PAIRS {
        if pair > 0 && slot.is_over() {
            break;
        }
        let folder = TempDir::new().map_err(|error| StudyError::Folder(error.to_string()))?;
        for seconds in &mut seconds {
            run.report(&format!("{}, kernel", report.name()))?;
            match in_process(program, adapter, folder.path()) {
                Ok(time) => seconds.push(time),
                Err(why) => {
                    report.leave_out("kernel", "", why);
                    return Ok(());
                }
            }
        }
    }
    report.add("kernel", "cold", SECONDS, &seconds[0]);
    report.add("kernel", "from the cache", SECONDS, &seconds[1]);
    Ok(())
}

/// Seconds as another process measures them, or its error message.
fn in_process(program: &Path, adapter: &GpuAdapter, folder: &Path) -> Result<f64, String> {
    let child = Command::new(program)
        .args(["benchmark", "--compile-on", &adapter.key()])
        .envs(FOLDERS.map(|variable| (variable, folder)))
        .output()
        .map_err(|error| error.to_string())?;
    let output = String::from_utf8_lossy(&child.stdout);
    output.trim().parse().map_err(|_| {
        let errors = String::from_utf8_lossy(&child.stderr);
        errors
            .lines()
            .last()
            .unwrap_or("the process that compiles ended without an answer")
            .to_owned()
    })
}

/// Compiles the default scene's kernel on the adapter with this key, up to its first dispatch.
///
/// # Errors
/// An adapter that is not there, or cannot render.
pub fn compile_on(key: &str) -> Result<Duration, StudyError> {
    let adapter = GpuAdapter::all().into_iter().find(|adapter| adapter.key() == key);
    let adapter = adapter.ok_or(crate::gpu::GpuError::NoAdapter(""))?;
    let mut session = Session::on_adapter(&adapter, Traversal::Own)?;
    let document = default_scene(SIZE);
    let begun = Instant::now();
    session.submit(&document)?;
    session.step(Duration::from_millis(1))?;
    Ok(begun.elapsed())
}
