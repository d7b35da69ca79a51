//! Job templates, run by the standard's own command line with several workers.

use std::{
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};

use super::exchange_tools::tools;
use crate::cli_support::Workplace;

/// Longest time for the tasks of a test.
const PATIENCE: Duration = Duration::from_secs(240);

fn openjd(place: &Workplace, arguments: &[&str]) -> Command {
    let mut command = Command::new(tools().join("bin/openjd"));
    command.args(arguments).current_dir(place.path(""));
    command
}

/// A worker that runs tasks of the step Render, one after the other.
fn worker(place: &Workplace, name: &str, tasks: &[[u32; 2]]) -> Child {
    let task = |[picture, slice]: &[u32; 2]| format!("{{\"Picture\": {picture}, \"Slice\": {slice}}}");
    let tasks = format!("[{}]", tasks.iter().map(task).collect::<Vec<_>>().join(", "));
    let log = std::fs::File::create(place.path(&format!("{name}.log"))).unwrap();
    let program = format!("Glossmith={}", crate::program());
    let arguments = [
        "run",
        "job.yaml",
        "--step",
        "Render",
        "--tasks",
        &tasks,
        "-p",
        &program,
        "-p",
        "Engine=cpu",
    ];
    openjd(place, &arguments)
        .stdout(log.try_clone().unwrap())
        .stderr(log)
        .stdin(Stdio::null())
        .spawn()
        .unwrap()
}

fn finish(place: &Workplace, mut worker: Child, name: &str) {
    let status = worker.wait().unwrap();
    assert!(status.success(), "{name}: {}", place.read(&format!("{name}.log")));
}

/// The processes that a process has started, and those that they have.
fn descendants(of: u32) -> Vec<u32> {
    let mut found = vec![of];
    let entries = std::fs::read_dir("/proc").unwrap().flatten();
    let parents: Vec<(u32, u32)> = entries
        .filter_map(|entry| {
            let process = entry.file_name().to_string_lossy().parse().ok()?;
            let stat = std::fs::read_to_string(entry.path().join("stat")).ok()?;
            // Behind the name in brackets: state, parent.
            let parent = stat.rsplit_once(") ")?.1.split(' ').nth(1)?.parse().ok()?;
            Some((process, parent))
        })
        .collect();
    let mut next = 0;
    while let Some(parent) = found.get(next).copied() {
        found.extend(
            parents
                .iter()
                .filter(|(_, of)| *of == parent)
                .map(|(process, _)| *process),
        );
        next += 1;
    }
    found
}

/// Ends a worker and all that it has started, as a machine that loses its power does.
fn kill(mut worker: Child) {
    let all: Vec<String> = descendants(worker.id()).iter().map(u32::to_string).collect();
    // Some may have ended by now.
    let _ = Command::new("kill").arg("-9").args(&all).stderr(Stdio::null()).status();
    worker.wait().unwrap();
}

fn wait_for(path: &Path) {
    let begun = Instant::now();
    while !path.is_file() {
        assert!(begun.elapsed() < PATIENCE, "{} does not come", path.display());
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn parts(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().flatten().map(|entry| entry.path());
    let is_part = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        name.ends_with(".json") && name.matches('.').count() == 2
    };
    entries.filter(is_part).collect()
}

#[test]
fn workers_of_a_farm_make_the_pictures_of_one_machine() {
    let place = Workplace::new();
    place.write(
        "a.toml",
        b"materials = [\"gold\", \"car-paint-red\"]\nformats = [\"png\", \"exr\"]\n[common]\nmodel = \"sphere\"\n\
          size = \"16x16\"\nsamples = 8\n",
    );
    place.done("batch a.toml --engine cpu --folder one");
    place.done("batch a.toml --job-template job.yaml --slices 3");
    let output = openjd(&place, &["check", "job.yaml"]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    // Two workers, each with one picture in three tasks. The second is killed after its first task.
    let first = worker(&place, "first", &[[1, 1], [1, 2], [1, 3]]);
    let second = worker(&place, "second", &[[2, 1], [2, 2], [2, 3]]);
    wait_for(&place.path("pictures/car-paint-red.0-2.json"));
    kill(second);
    assert!(
        !place.path("pictures/car-paint-red.5-8.json").is_file(),
        "it was not killed in the middle"
    );
    finish(&place, first, "first");
    // The farm gives its tasks to another one; what was done stays.
    let again = worker(&place, "again", &[[2, 1], [2, 2], [2, 3]]);
    finish(&place, again, "again");
    assert!(
        place.read("again.log").contains("\"kept\""),
        "{}",
        place.read("again.log")
    );
    assert_eq!(parts(&place.path("pictures")).len(), 6);
    collect(&place, "--no-run-dependencies");
    for name in ["gold", "car-paint-red"] {
        for ending in ["png", "exr"] {
            let [one, farm] = ["one", "pictures"]
                .map(|folder| std::fs::read(place.path(&format!("{folder}/{name}.{ending}"))).unwrap());
            assert!(one == farm, "{name}.{ending} is another picture");
        }
    }
    assert!(place.path("pictures/contact-sheet.png").is_file());
}

/// Runs a job's last step, with or without those before it.
fn collect(place: &Workplace, dependencies: &str) {
    let program = format!("Glossmith={}", crate::program());
    let run = [
        "run",
        "job.yaml",
        "--step",
        "Collect",
        dependencies,
        "-p",
        &program,
        "-p",
        "Engine=cpu",
    ];
    let output = openjd(place, &run).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
}

#[test]
fn a_template_of_whole_pictures_runs_in_one_go() {
    let place = Workplace::new();
    place.write(
        "a.toml",
        b"materials = [\"gold\", \"silver\"]\n[common]\nmodel = \"sphere\"\nsize = \"16x16\"\nsamples = 2\n",
    );
    place.done("batch a.toml --job-template job.yaml --folder out");
    collect(&place, "--run-dependencies");
    assert!(place.path("out/gold.png").is_file() && place.path("out/silver.png").is_file());
    assert!(place.path("out/contact-sheet.html").is_file());
}
