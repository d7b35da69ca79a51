//! The same arguments and the same seed: the same files, byte for byte, however many threads there are and however busy the
//! machine is.

use std::process::Command;

use super::cli_support::Workplace;

/// Renders by these arguments with so many threads; the files' bytes, and the number of samples.
fn files(place: &Workplace, arguments: &str, threads: u32) -> (Vec<Vec<u8>>, f64) {
    let all =
        format!("render --engine cpu --keep-sums --aovs --output a.exr --output a.png --report a.json {arguments}");
    let output = Command::new(crate::program())
        .args(all.split_whitespace())
        .current_dir(place.path("."))
        .env("RAYON_NUM_THREADS", threads.to_string())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: serde_json::Value = place.json("a.json");
    let bytes = ["a.exr", "a.png"].map(|name| place.bytes(name));
    (bytes.into(), report["mean_samples_per_pixel"].as_f64().unwrap())
}

/// Passes were sized by the clock: rests and the end of rendering came after other numbers of samples each time, and the
/// deviations behind the variance were rounded after each pass.
#[test]
fn the_same_arguments_write_the_same_files() {
    let place = Workplace::new();
    let scene = "--model sphere --material silver --size 48x40 --seed 3";
    for (how, most) in [
        ("--samples 32 --adaptive on", 31.9),
        ("--samples 4096 --noise 0.08 --denoise auto", 4000.0),
        ("--samples 4096 --noise 0.06 --region 0.2,0.3,0.7,0.9", 4000.0),
    ] {
        let arguments = format!("{scene} {how}");
        let (first, samples) = files(&place, &arguments, 1);
        assert!(samples <= most, "{how}: {samples}, not what is meant");
        for threads in [2, 3] {
            let (again, count) = files(&place, &arguments, threads);
            assert!(
                again == first,
                "{how}, {threads} threads: other files, {samples} and {count} samples"
            );
        }
    }
}
