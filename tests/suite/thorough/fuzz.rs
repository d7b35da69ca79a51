//! The corpus of the fuzz targets, whole and damaged: a result or an error within 10 s and ten times the file's memory,
//! never a panic.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use super::support::Random;

#[path = "../../../fuzz/formats.rs"]
mod formats;

/// Damaged files made of each file of the corpus.
const DAMAGED: usize = 120;
/// The longest that a file may take.
const TIME_MAX: Duration = Duration::from_secs(30);
/// What a process may need beyond ten times the file: the tables of decoders and their threads.
const MEMORY_FLOOR_KIB: u64 = 48 << 10;
/// Tells the child process that it is one.
const CHILD: &str = "GLOSSMITH_FUZZ_CHILD";

fn corpus() -> Vec<(&'static str, PathBuf)> {
    let root = Path::new(crate::ROOT).join("fuzz/corpus");
    let files_of = |format: &'static str| {
        let mut files: Vec<_> = fs::read_dir(root.join(format))
            .unwrap_or_else(|error| panic!("fuzz/corpus/{format}: {error}"))
            .map(|entry| entry.unwrap().path())
            .collect();
        files.sort();
        files.into_iter().map(move |path| (format, path))
    };
    formats::FORMATS.into_iter().flat_map(files_of).collect()
}

/// Bytes changed, cut, doubled, overwritten by numbers that mean much, or spliced with another file.
fn damaged(bytes: &[u8], other: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..1 + random.below(4) {
        if bytes.is_empty() {
            return bytes;
        }
        let at = random.below(bytes.len());
        match random.below(8) {
            0 => bytes.truncate(at),
            1 => {
                let end = (at + 1 + random.below(64)).min(bytes.len());
                let part = bytes[at..end].to_vec();
                bytes.splice(at..at, part);
            }
            2 => {
                let numbers = [
                    0,
                    1,
                    0x7fff_ffff,
                    0x8000_0000,
                    u32::MAX,
                    0xffff,
                    0x7fc0_0000,
                    0x4000_0000,
                ];
                let number = numbers[random.below(numbers.len())].to_le_bytes();
                let end = (at + 4).min(bytes.len());
                bytes[at..end].copy_from_slice(&number[..end - at]);
            }
            3 => {
                let from = random.below(other.len().max(1));
                bytes.truncate(at);
                bytes.extend(&other[from.min(other.len())..]);
            }
            // Digits stay valid text and change what it means.
            _ if bytes[at].is_ascii_digit() => bytes[at] = b'0' + random.below(10) as u8,
            _ => bytes[at] = random.bits() as u8,
        }
    }
    bytes
}

/// The most memory that this process has had since it was last asked, KiB; and starts anew.
fn peak_kib() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let peak = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    fs::write("/proc/self/clear_refs", "5").ok()?;
    Some(peak)
}

/// In a process of its own, so that what other tests need does not count.
#[test]
fn damaged_files_of_the_corpus_are_refused_or_read() {
    if std::env::var_os(CHILD).is_none() {
        let child = Command::new(std::env::current_exe().unwrap())
            .args([
                "fuzz::damaged_files_of_the_corpus_are_refused_or_read",
                "--exact",
                "--nocapture",
            ])
            .env(CHILD, "1")
            .output()
            .unwrap();
        let text = String::from_utf8_lossy(&child.stdout) + String::from_utf8_lossy(&child.stderr);
        println!("{text}");
        assert!(child.status.success(), "{text}");
        return;
    }
    let files = corpus();
    assert!(files.len() >= 10, "{files:?}");
    let mut random = Random::new(2026);
    for (format, path) in &files {
        let whole = fs::read(path).unwrap();
        let other = fs::read(&files[random.below(files.len())].1).unwrap();
        let (mut slowest, mut hungriest) = (Duration::ZERO, 0);
        for i in 0..=DAMAGED {
            let bytes = if i == 0 {
                whole.clone()
            } else {
                damaged(&whole, &other, &mut random)
            };
            let before = peak_kib().and_then(|_| peak_kib());
            let begun = Instant::now();
            formats::try_file(format, &bytes);
            let took = begun.elapsed();
            slowest = slowest.max(took);
            assert!(took < TIME_MAX, "{}, damage {i}: {took:?}", path.display());
            // Where the system tells no such thing, nothing is known.
            if let (Some(before), Some(after)) = (before, peak_kib()) {
                let allowed = 10 * bytes.len() as u64 / 1024 + MEMORY_FLOOR_KIB;
                let needed = after.saturating_sub(before);
                hungriest = hungriest.max(needed);
                assert!(
                    needed <= allowed,
                    "{}, damage {i}: {needed} KiB, {allowed} allowed",
                    path.display()
                );
            }
        }
        println!(
            "{:24} {slowest:?}, {hungriest} KiB",
            path.file_name().unwrap().to_string_lossy()
        );
    }
}
