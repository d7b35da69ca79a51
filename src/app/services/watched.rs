//! Files that other programs may save while they are shown. They are looked at now and then: that works on every disk, and
//! for programs that replace a file as well as for those that write into it.

use std::{collections::HashMap, path::Path, path::PathBuf, time::Duration, time::SystemTime};

use crate::services::beside::Beside;

/// From one look to the next. A file counts as saved when it was the same at two looks.
const INTERVAL: Duration = Duration::from_millis(500);

/// When a file was changed, and its length; nothing where it is not there.
type Stamp = Option<(SystemTime, u64)>;

/// The files that are looked at, and how many looks found one saved, as far as that was told.
#[derive(Default)]
pub struct Watched {
    looks: Beside<Vec<(PathBuf, Stamp)>, u64>,
    paths: Vec<PathBuf>,
    told: Option<u64>,
}

fn stamp(path: &Path) -> Stamp {
    let metadata = std::fs::metadata(path).ok()?;
    Some((metadata.modified().ok()?, metadata.len()))
}

impl Watched {
    /// Watches these files from now on; those already watched keep their state. Whether one was saved since this was last
    /// called.
    pub fn watch(&mut self, ctx: &egui::Context, paths: Vec<PathBuf>) -> bool {
        if self.paths != paths {
            // As they are now: the thread may come to them after another program did.
            let stamped = paths.iter().map(|path| (path.clone(), stamp(path))).collect();
            self.paths = paths;
            self.look(ctx, stamped);
        }
        let latest = self.looks.latest();
        std::mem::replace(&mut self.told, latest) != latest
    }

    fn look(&mut self, ctx: &egui::Context, files: Vec<(PathBuf, Stamp)>) {
        // As each was read, and at the last look.
        let mut stamps: HashMap<PathBuf, [Stamp; 2]> = HashMap::new();
        let mut saved = 0;
        self.looks.ask_again(ctx, "watched", files, move |files, responder| {
            stamps.retain(|path, _| files.iter().any(|(file, _)| file == path));
            for (path, now) in files {
                stamps.entry(path).or_insert([now; 2]);
            }
            while !responder.is_superseded() {
                std::thread::sleep(INTERVAL);
                let before = saved;
                for (path, [read, seen]) in &mut stamps {
                    let now = stamp(path);
                    // While it is being replaced it is not there, while it is being written it grows.
                    if now.is_some() && now == *seen && now != *read {
                        *read = now;
                        saved += 1;
                    }
                    *seen = now;
                }
                if saved > before {
                    responder.publish(saved);
                }
            }
        });
    }
}
