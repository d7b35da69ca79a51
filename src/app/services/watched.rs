//! Files that other programs may save while they are shown. They are looked at now and then: that works on every disk, and
//! for programs that replace a file as well as for those that write into it.

use crate::panics::lock;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, Weak};
use std::time::{Duration, SystemTime};

/// From one look to the next. A file counts as saved when it was the same at two looks.
pub const INTERVAL: Duration = Duration::from_millis(500);

/// When a file was changed, and its length; nothing where it is not there.
type Stamp = Option<(SystemTime, u64)>;

/// The files that are looked at.
pub struct Watched(Arc<Mutex<Vec<File>>>);

struct File {
    path: PathBuf,
    /// As it was read.
    read: Stamp,
    /// At the last look.
    seen: Stamp,
    has_changed: bool,
}

impl File {
    fn new(path: PathBuf) -> Self {
        let read = stamp(&path);
        Self {
            path,
            read,
            seen: read,
            has_changed: false,
        }
    }

    /// Looks at it; true where it has been saved.
    fn look(&mut self) -> bool {
        let now = stamp(&self.path);
        // While it is being replaced it is not there, while it is being written it grows.
        let is_settled = now.is_some() && now == self.seen;
        self.seen = now;
        if is_settled && now != self.read {
            self.read = now;
            self.has_changed = true;
            return true;
        }
        false
    }
}

fn stamp(path: &PathBuf) -> Stamp {
    let metadata = std::fs::metadata(path).ok()?;
    Some((metadata.modified().ok()?, metadata.len()))
}

impl Watched {
    /// Starts the thread, which ends with this value. `repaint` is called when a file was saved.
    pub fn new(interval: Duration, repaint: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let files = Arc::new(Mutex::new(Vec::new()));
        let of_thread: Weak<Mutex<Vec<File>>> = Arc::downgrade(&files);
        std::thread::Builder::new().name("watched".to_owned()).spawn(move || {
            loop {
                std::thread::sleep(interval);
                let Some(files) = of_thread.upgrade() else { return };
                let mut is_news = false;
                for file in lock(&files).iter_mut() {
                    is_news |= file.look();
                }
                if is_news {
                    repaint();
                }
            }
        })?;
        Ok(Self(files))
    }

    /// Watches these files from now on; those already watched keep their state.
    pub fn watch(&self, paths: &[PathBuf]) {
        let mut files = lock(&self.0);
        let is_same = files.len() == paths.len() && files.iter().zip(paths).all(|(file, path)| file.path == *path);
        if is_same {
            return;
        }
        let mut known = std::mem::take(&mut *files);
        *files = paths
            .iter()
            .map(|path| match known.iter().position(|file| file.path == *path) {
                Some(place) => known.swap_remove(place),
                None => File::new(path.clone()),
            })
            .collect();
    }

    /// Those that were saved since this was last called.
    pub fn take_changed(&self) -> Vec<PathBuf> {
        let mut files = lock(&self.0);
        let taken = |file: &mut File| std::mem::take(&mut file.has_changed).then(|| file.path.clone());
        files.iter_mut().filter_map(taken).collect()
    }
}
