//! What was there before stays where something goes wrong.

use super::cli_support::Workplace;

/// A device that is linked to by the name of a picture is not replaced by it, and a pipe is not waited for.
#[cfg(unix)]
#[test]
fn what_is_no_file_is_refused_as_a_target() {
    let place = Workplace::new();
    // Where a file would take its place nothing but the link is lost.
    std::os::unix::fs::symlink("/dev/null", place.path("device.png")).unwrap();
    let pipe = place.path("pipe.png");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status().unwrap();
    assert!(made.success());
    for name in ["device.png", "pipe.png"] {
        for arguments in [
            "render --engine cpu --size 16x16 --samples 1",
            "lobe --plot polar --lobe ggx:0.3",
        ] {
            let words = [name, "cannot be saved", "a device or a pipe"];
            place.refused(1, &format!("{arguments} --output {name}"), &words);
        }
    }
    use std::os::unix::fs::FileTypeExt as _;
    assert!(std::fs::metadata("/dev/null").unwrap().file_type().is_char_device());
    assert!(std::fs::metadata(&pipe).unwrap().file_type().is_fifo());
}

/// A folder in which no file can be made: what is there could be overwritten in place, and must not be.
#[cfg(unix)]
#[test]
fn plots_numbers_and_reports_are_replaced_whole_or_not_at_all() {
    use std::os::unix::fs::MetadataExt as _;
    let place = Workplace::new();
    for (name, arguments) in [
        ("lobe.csv", "lobe --plot polar --lobe ggx:0.3 --output lobe.csv"),
        ("lobe.svg", "lobe --plot polar --lobe ggx:0.3 --output lobe.svg"),
        ("lobe.png", "lobe --plot polar --lobe ggx:0.3 --output lobe.png"),
        (
            "drawn.csv",
            "scatter --lobe ggx --count 9 --engine cpu --output drawn.csv",
        ),
        (
            "drawn.png",
            "scatter --lobe ggx --count 9 --engine cpu --output drawn.png",
        ),
        ("plan.json", "plan --size 16x16 --json plan.json"),
    ] {
        place.write(name, b"old");
        let old = std::fs::File::open(place.path(name)).unwrap();
        place.done(arguments);
        // A new file has taken the place of the old one, which was not written into.
        assert_ne!(
            old.metadata().unwrap().ino(),
            place.path(name).metadata().unwrap().ino(),
            "{name}"
        );
        assert_eq!(std::io::read_to_string(old).unwrap(), "old", "{name}");
        assert!(place.path(name).metadata().unwrap().len() > 20, "{name}");
    }
}

/// A target that can't be written is told before the work, whichever command it is of: the model is not even read.
#[test]
fn every_target_is_asked_before_the_work() {
    let place = Workplace::new();
    std::fs::create_dir(place.path("folder.png")).unwrap();
    std::fs::create_dir(place.path("folder.json")).unwrap();
    place.write("m.obj", b"not a model");
    place.write("file", b"");
    for (target, arguments) in [
        ("none/p.png", "render m.obj --output none/p.png"),
        ("file/p.exr", "render m.obj --output file/p.exr"),
        ("folder.png", "render m.obj --output folder.png"),
        ("none/r.json", "render m.obj --report none/r.json"),
        ("none/a.json", "convert m.obj none/a.json"),
        ("none/r.json", "convert m.obj a.json --report none/r.json"),
        ("none/r.json", "render m.obj --import-report none/r.json"),
        ("none/t.gif", "turntable m.obj --video none/t.gif"),
        ("none/s.csv", "scatter --lobe ggx --count 100000000 --output none/s.csv"),
        ("folder.png", "scatter --lobe ggx --count 100000000 --output folder.png"),
        ("folder.png", "lobe --plot polar --lobe ggx:0.3 --output folder.png"),
        ("none/c.json", "check --json none/c.json"),
        ("folder.json", "fit --target ggx:0.3 --output folder.json"),
    ] {
        place.refused(1, arguments, &[target]);
    }
}
