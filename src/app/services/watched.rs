//! Files that other programs may save while they are shown. They are looked at now and then: that works on every disk, and
//! for programs that replace a file as well as for those that write into it.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::{Duration, SystemTime};

use crate::panics::lock;

/// From one look to the next. A file counts as saved when it was the same at two looks.
const INTERVAL: Duration = Duration::from_millis(500);

/// When a file was changed, and its length; nothing where it is not there.
type Stamp = Option<(SystemTime, u64)>;

/// The files that are looked at.
pub struct Watched(Arc<Mutex<Files>>);

#[derive(Default)]
struct Files {
    /// As each was read, and at the last look.
    stamps: HashMap<PathBuf, [Stamp; 2]>,
    have_changed: bool,
}

impl Files {
    /// Whether one of them has been saved.
    fn look(&mut self) -> bool {
        let mut is_news = false;
        for (path, [read, seen]) in &mut self.stamps {
            let now = stamp(path);
            // While it is being replaced it is not there, while it is being written it grows.
            if now.is_some() && now == *seen && now != *read {
                *read = now;
                is_news = true;
            }
            *seen = now;
        }
        self.have_changed |= is_news;
        is_news
    }
}

fn stamp(path: &Path) -> Stamp {
    let metadata = std::fs::metadata(path).ok()?;
    Some((metadata.modified().ok()?, metadata.len()))
}

impl Watched {
    /// Starts the thread, which ends with this value. `repaint` is called when a file was saved.
    pub fn new(repaint: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let files = Arc::new(Mutex::new(Files::default()));
        let of_thread = Arc::downgrade(&files);
        std::thread::Builder::new().name("watched".to_owned()).spawn(move || {
            loop {
                std::thread::sleep(INTERVAL);
                let Some(files) = of_thread.upgrade() else { return };
                if lock(&files).look() {
                    repaint();
                }
            }
        })?;
        Ok(Self(files))
    }

    /// Watches these files from now on; those already watched keep their state. Whether one was saved since this was last
    /// called.
    pub fn watch(&self, paths: Vec<PathBuf>) -> bool {
        let mut files = lock(&self.0);
        let mut known = std::mem::take(&mut files.stamps);
        let with_stamps = |path: PathBuf| {
            let stamps = known.remove(&path).unwrap_or_else(|| [stamp(&path); 2]);
            (path, stamps)
        };
        files.stamps = paths.into_iter().map(with_stamps).collect();
        std::mem::take(&mut files.have_changed)
    }
}
