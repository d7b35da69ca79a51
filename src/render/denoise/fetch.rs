//! The denoiser, fetched for the user: the official binaries of Open Image Denoise, as a Python package.

use std::{io, path::Path, path::PathBuf, process::Command, process::Stdio, time::Duration};

use super::library::{Library, data_folder};

/// What is downloaded, in words.
pub const DOWNLOAD: &str = "90 MB";
const DOWNLOAD_BYTES: f32 = 9e7;
/// From one look at the download to the next.
const LOOK: Duration = Duration::from_millis(200);

/// The package, as in `scripts/setup`.
const PACKAGE: &str = "pyoidn==2.5.1.0";
/// Where its libraries lie in it.
const IN_PACKAGE: &str = "pyoidn/oidn/lib";
/// Beginnings of the names of those that are needed.
const NEEDED: [&str; 4] = [
    "libtbb.so.12",
    "libOpenImageDenoise_core.so.",
    "libOpenImageDenoise_device_cpu.so.",
    "libOpenImageDenoise.so.2",
];
/// Programs that install Python packages, with their first arguments, the likeliest first.
pub type Installers<'a> = &'a [&'a [&'a str]];
const INSTALLERS: Installers<'_> = &[&["python3", "-m", "pip"], &["pip3"], &["uv", "pip"]];

/// Whether the denoiser can be fetched on this system.
pub fn can_fetch() -> bool {
    cfg!(target_os = "linux") && data_folder().is_some()
}

/// Downloads the denoiser into the folder where the program looks for it, and has it looked for again; see [`fetch_into`].
pub fn fetch(goes_on: &dyn Fn(f32) -> bool) -> Result<(), String> {
    let folder = data_folder().ok_or("there is no folder for it: set HOME")?;
    fetch_into(&folder, INSTALLERS, goes_on)?;
    Library::look_again();
    Ok(())
}

/// Downloads the denoiser into a folder by the first of the installers that is there. `goes_on` hears the share that is
/// there, which never falls, and ends the download by false.
pub fn fetch_into(folder: &Path, installers: Installers<'_>, goes_on: &dyn Fn(f32) -> bool) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(failed(folder))?;
    // Beside where it goes to: files are moved within one file system.
    let taken = tempfile::tempdir_in(folder).map_err(failed(folder))?;
    install(taken.path(), installers, goes_on)?;
    let there = taken.path().join(IN_PACKAGE);
    // All or none.
    let found: Vec<PathBuf> = NEEDED
        .iter()
        .map(|name| {
            super::library::file_beginning_with(&there, name)
                .ok_or_else(|| format!("the package {PACKAGE} has no {name} for this machine"))
        })
        .collect::<Result<_, _>>()?;
    for file in found {
        let to = folder.join(file.file_name().unwrap_or_default());
        std::fs::rename(&file, &to).map_err(failed(&to))?;
    }
    Ok(())
}

/// Bytes of the files below a folder.
fn size_of(folder: &Path) -> u64 {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let size = |entry: std::fs::DirEntry| match entry.metadata() {
        Ok(found) if found.is_dir() => size_of(&entry.path()),
        Ok(found) => found.len(),
        Err(_) => 0,
    };
    entries.map(size).sum()
}

fn failed(path: &Path) -> impl FnOnce(io::Error) -> String {
    move |error| format!("{}: {error}", path.display())
}

fn install(target: &Path, installers: Installers<'_>, goes_on: &dyn Fn(f32) -> bool) -> Result<(), String> {
    let failed = |why: &str| Err(format!("the download of {PACKAGE} failed: {why}"));
    let mut share = 0.0_f32;
    for installer in installers {
        let Some((program, arguments)) = installer.split_first() else {
            continue;
        };
        let mut command = Command::new(program);
        command
            .args(arguments)
            .args(["install", "--no-deps", "--target"])
            .arg(target)
            .arg(PACKAGE)
            // The installer downloads there first.
            .env("TMPDIR", target)
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        let ended = command.spawn().and_then(|mut child| {
            while child.try_wait()?.is_none() {
                // What was downloaded is deleted once it is unpacked.
                share = share.max(size_of(target) as f32 / DOWNLOAD_BYTES).min(0.99);
                if !goes_on(share) {
                    child.kill()?;
                }
                std::thread::sleep(LOOK);
            }
            child.wait_with_output()
        });
        match ended {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => return failed(&error.to_string()),
            Ok(output) if output.status.success() => return Ok(()),
            Ok(_) if !goes_on(share) => return Err("the download was stopped".to_owned()),
            Ok(output) => {
                let said = String::from_utf8_lossy(&output.stderr).into_owned();
                // A Python without pip: another installer may be there.
                if !said.contains("No module named pip") {
                    let last = said.lines().rfind(|line| !line.trim().is_empty());
                    return failed(last.unwrap_or("no reason given"));
                }
            }
        }
    }
    Err("nothing here can download it: install python3-pip, then press the button again".to_owned())
}
