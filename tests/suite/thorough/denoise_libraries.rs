//! Libraries in the place of Open Image Denoise, made by the C compiler: those that cannot be used, and one with a GPU.

use std::{path::Path, process::Command};

use super::cli_support::Workplace;

/// Missing, broken, incomplete and old libraries: one line that says what to do, and the picture without.
#[test]
fn a_library_that_cannot_be_used_is_told_in_a_line() {
    let place = Workplace::new();
    let folder = |name: &str| {
        let folder = place.path(name);
        std::fs::create_dir_all(&folder).unwrap();
        folder
    };
    let library = "libOpenImageDenoise.so.2";
    folder("empty");
    std::fs::write(folder("broken").join(library), b"not a library").unwrap();
    compile("int nothing;", &folder("incomplete").join(library));
    compile(OLD_LIBRARY, &folder("old").join(library));
    let cases = [
        ("empty", "there is no libOpenImageDenoise.so.2"),
        ("broken", "can't be loaded as the denoiser"),
        ("incomplete", "oidnGetNumPhysicalDevices"),
        ("old", "Open Image Denoise 2.1.0 is too old"),
    ];
    for (name, words) in cases {
        let output = Command::new(crate::program())
            .args("render --engine cpu --size 8x8 --samples 2 --denoise fast --report r.json --output a.png".split(' '))
            .current_dir(place.path("."))
            .env("GLOSSMITH_OIDN", place.path(name))
            .env_remove("RUST_LOG")
            .output()
            .unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{name}: {text}");
        let told: Vec<_> = text.lines().filter(|line| line.contains("not denoised")).collect();
        assert_eq!(told.len(), 1, "{name}: {text}");
        assert!(
            told[0].contains(words) && told[0].contains(&*place.path(name).to_string_lossy()),
            "{text}"
        );
        assert!(place.read("r.json").contains("\"denoised\": null"), "{name}");
    }
}

fn compile(source: &str, to: &Path) {
    let file = to.with_extension("c");
    std::fs::write(&file, source).unwrap();
    let status = Command::new("cc")
        .args(["-shared", "-fPIC", "-w", "-o"])
        .arg(to)
        .arg(&file)
        .status()
        .unwrap();
    assert!(status.success(), "cc, which building needs, too");
}

/// A library with a GPU and a CPU, whose filter copies colour to output and reddens it on the CPU: the GPU is asked first, and
/// where it fails the CPU takes over with a message. The GPU's memory is not the host's, the CPU's is.
#[test]
fn the_gpu_denoises_and_the_cpu_takes_over_where_it_fails() {
    let place = Workplace::new();
    let folder = |name: &str, source: &str| {
        let folder = place.path(name);
        std::fs::create_dir_all(&folder).unwrap();
        compile(source, &folder.join("libOpenImageDenoise.so.2"));
        folder
    };
    let working = folder("working", TWO_DEVICES);
    let failing = folder("failing", &TWO_DEVICES.replace("int fails = 0", "int fails = 1"));
    let absent = folder("absent", &TWO_DEVICES.replace("opens = 1", "opens = 0"));
    // Whether the image is red, and what was said.
    let reddened = |library: &Path, device: &str| {
        let arguments = "render --engine cpu --model plane --environment furnace --environment-strength 0.2 --size 8x8";
        let output = Command::new(crate::program())
            .args(arguments.split(' '))
            .args([
                "--samples",
                "2",
                "--denoise",
                "fast",
                "--denoise-device",
                device,
                "--output",
                "a.png",
            ])
            .current_dir(place.path("."))
            .env("GLOSSMITH_OIDN", library)
            .env_remove("RUST_LOG")
            .output()
            .unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{text}");
        let [red, green, ..] = image::open(place.path("a.png")).unwrap().to_rgb8().get_pixel(4, 4).0;
        (red > green.saturating_add(50), text)
    };
    let (is_cpu, text) = reddened(&working, "auto");
    assert!(!is_cpu && !text.contains("WARN"), "{text}");
    assert!(reddened(&working, "cpu").0);
    let (is_cpu, text) = reddened(&failing, "gpu");
    assert!(is_cpu && text.contains("the CUDA device stopped denoising"), "{text}");
    assert!(text.contains("out of memory"), "{text}");
    let (is_cpu, text) = reddened(&absent, "gpu");
    assert!(is_cpu && text.contains("no GPU can denoise here"), "{text}");
}

const TWO_DEVICES: &str = r#"
    #include <stdlib.h>
    #include <string.h>
    int fails = 0, opens = 1;
    static int error, devices[2];
    typedef struct { void *data; int on_gpu; size_t size; } Buffer;
    static Buffer *color, *output;
    int oidnGetNumPhysicalDevices() { return 2; }
    int oidnGetPhysicalDeviceInt(int id, const char *name) { return id == 0 ? 3 : 1; }
    void *oidnNewDeviceByID(int id) { return id == 0 && !opens ? 0 : &devices[id]; }
    int oidnGetDeviceInt(void *device, const char *name) { return 20500; }
    int oidnGetDeviceError(void *device, const char **text) { int was = error; error = 0; *text = "out of memory"; return was; }
    void oidnCommitDevice() {} void oidnReleaseDevice() {} void oidnSetDeviceBool() {}
    void *oidnNewBuffer(void *device, size_t size) {
        Buffer *buffer = malloc(sizeof(Buffer));
        buffer->data = malloc(size); buffer->on_gpu = device == &devices[0]; buffer->size = size;
        return buffer;
    }
    void *oidnGetBufferData(Buffer *buffer) { return buffer->on_gpu ? (void *)64 : buffer->data; }
    int oidnGetBufferStorage(Buffer *buffer) { return buffer->on_gpu ? 2 : 1; }
    void oidnReleaseBuffer(Buffer *buffer) { free(buffer->data); free(buffer); }
    void oidnWriteBuffer(Buffer *buffer, size_t at, size_t size, const void *from) { memcpy(buffer->data, from, size); }
    void oidnReadBuffer(Buffer *buffer, size_t at, size_t size, void *to) { memcpy(to, buffer->data, size); }
    void *oidnNewFilter(void *device, const char *kind) { return device; }
    void oidnReleaseFilter() {}
    void oidnSetFilterImage(void *filter, const char *name, Buffer *buffer) {
        if (!strcmp(name, "color")) color = buffer;
        if (!strcmp(name, "output")) output = buffer;
    }
    void oidnExecuteFilter(void *filter) {
        if (filter == &devices[0] && fails) { error = 3; return; }
        memcpy(output->data, color->data, color->size);
        if (filter == &devices[1]) for (size_t i = 0; i < color->size / 4; i += 3) ((float *)output->data)[i] = 1;
    }
    void oidnSetFilterBool() {} void oidnSetFilterInt() {} int oidnGetFilterInt() { return 1; }
    void oidnSetFilterFloat() {} void oidnCommitFilter() {} void oidnSetFilterProgressMonitorFunction() {}
"#;

/// All functions, and a device of version 2.1.0.
const OLD_LIBRARY: &str = "
    static int thing;
    int oidnGetNumPhysicalDevices() { return 1; }
    int oidnGetPhysicalDeviceInt(int id, const char *name) { return 1; }
    void *oidnNewDeviceByID(int id) { return &thing; }
    void *oidnGetBufferData(void *buffer) { return 0; } int oidnGetBufferStorage(void *buffer) { return 0; }
    int oidnGetDeviceInt(void *device, const char *name) { return name[0] == 'v' ? 20100 : 1; }
    int oidnGetDeviceError(void *device, const char **text) { return 0; }
    void oidnCommitDevice() {} void oidnReleaseDevice() {} void oidnSetDeviceBool() {}
    void oidnNewBuffer() {} void oidnReleaseBuffer() {} void oidnWriteBuffer() {} void oidnReadBuffer() {}
    void oidnNewFilter() {} void oidnReleaseFilter() {} void oidnSetFilterImage() {} void oidnSetFilterBool() {}
    void oidnSetFilterInt() {} void oidnGetFilterInt() {} void oidnSetFilterFloat() {} void oidnCommitFilter() {}
    void oidnExecuteFilter() {} void oidnSetFilterProgressMonitorFunction() {}
";
