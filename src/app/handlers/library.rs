//! What the window does about the user's folders.

use std::path::{Path, PathBuf};

use image::RgbaImage;

use crate::{
    App,
    document::Document,
    handlers::files::finish,
    layout::Pane,
    render::display::display,
    render::worker::{Activity, Picture},
    services::{disk::Task, library::Change, messages::LogEntry, pictures::uploaded},
    store::{FileError, library, library::Removed, snapshots},
};

/// Samples per pixel from which an image is clean at the size of a snapshot's.
const PINNED_FROM: u32 = 8;

/// What was done, and what was removed.
type Done = (Option<LogEntry>, Option<Removed>);

fn task(change: &Change) -> Task {
    if *change == Change::List {
        Task::List
    } else {
        Task::Write
    }
}

/// Makes a change that is the same in each folder, where `before` was removed last.
fn carry_out(
    change: &Change,
    before: Option<Removed>,
    rename: fn(&Path, &str) -> Result<PathBuf, FileError>,
) -> Result<Done, FileError> {
    let done = |verb, path: &Path| Some(LogEntry::done_with(verb, path, ""));
    Ok(match (change, before) {
        (Change::Rename(path, name), _) => (done("Renamed to", &rename(path, name)?), None),
        (Change::Remove(path), _) => (done("Removed", path), Some(library::remove(path)?)),
        (Change::Restore, Some(removed)) => (done("Restored", &library::restore(&removed)?), None),
        _ => (None, None),
    })
}

impl App {
    /// Changes the user's materials, beside the window.
    pub fn change_library(&mut self, change: Change) {
        let Some(folder) = self.shared.library.path.clone() else {
            if change != Change::List {
                self.fail("there is no folder for your materials: set HOME, or save the material as a file");
            }
            return;
        };
        let (material, before) = (self.desk_material(), self.shared.library.removed.take());
        self.files.disk.order(task(&change), move || {
            let saved = |path: PathBuf| (Some(LogEntry::done_with("Saved", &path, "one of your presets")), None);
            let done = match &change {
                Change::Add => library::add(&folder, &material).map(saved),
                Change::Duplicate(path) => library::duplicate(path).map(saved),
                change => carry_out(change, before, library::rename),
            };
            let listed = done.and_then(|done| Ok((done, library::list(&folder)?)));
            finish(move |app, _| {
                let Some(((done, removed), entries)) = app.taken(listed) else {
                    return false;
                };
                let library = &mut app.shared.library;
                (library.entries, library.removed) = (entries, removed);
                let added = done
                    .as_ref()
                    .and_then(|done| done.file.clone())
                    .filter(|_| change == Change::Add);
                if let Some(entry) = library.entries.iter().find(|entry| Some(&entry.path) == added.as_ref()) {
                    library.renaming = Some((entry.path.clone(), entry.name()));
                    app.reveal(Pane::Presets);
                }
                app.say_all(done);
                true
            })
        });
    }

    /// Changes the pinned states, beside the window.
    pub fn change_snapshots(&mut self, change: Change) {
        let Some(folder) = self.shared.snapshots.path.clone() else {
            if change != Change::List {
                self.fail(
                    "there is no folder for snapshots: set HOME, or save the image as a .png, which has the document inside",
                );
            }
            return;
        };
        let picture = self.worker.snapshot().picture.clone();
        if change == Change::Add && picture.is_none() {
            return self.warn("there is no image to pin yet");
        }
        let is_early = change == Change::Add && !self.has_whole_picture();
        let (document, before) = (self.document.clone(), self.shared.snapshots.removed.take());
        self.files.disk.order(task(&change), move || {
            let done = match (&change, picture) {
                (Change::Add | Change::Retake(_), Some(picture)) => {
                    let rgba = display(&picture.image, &picture.document.view);
                    let pixels = RgbaImage::from_raw(picture.width, picture.height, rgba).unwrap_or_default();
                    match &change {
                        Change::Retake(path) => snapshots::save(path, &document, &pixels).map(|()| (None, before)),
                        _ => snapshots::add(&folder, &document, &pixels)
                            .map(|path| (Some(LogEntry::done_with("Pinned", &path, "")), None)),
                    }
                }
                (change, _) => carry_out(change, before, snapshots::rename),
            };
            let listed = done.and_then(|done| Ok((done, snapshots::list(&folder)?)));
            finish(move |app, ctx| {
                let Some(((done, removed), (pinned, errors))) = app.taken(listed) else {
                    return false;
                };
                app.report_all(errors);
                app.shared.snapshots.removed = removed;
                let added = done.as_ref().and_then(|done| done.file.clone());
                if let Some(path) = added.filter(|_| is_early) {
                    app.shared.snapshots.unfinished = Some((path, document));
                }
                let known = std::mem::take(&mut app.shared.snapshots.entries);
                for pinned in pinned {
                    let texture = match known.iter().find(|(known, _)| *known == pinned) {
                        Some((_, texture)) => texture.clone(),
                        None => uploaded(ctx, &pinned.picture),
                    };
                    app.shared.snapshots.entries.push((pinned, texture));
                }
                app.say_all(done);
                true
            })
        });
    }

    fn has_whole_picture(&self) -> bool {
        let snapshot = self.worker.snapshot();
        let is_clean =
            |picture: &Picture| picture.samples_per_pixel >= PINNED_FROM || snapshot.activity == Activity::Done;
        let picture = snapshot.picture.as_deref();
        picture.is_some_and(|picture| self.is_whole(picture) && is_clean(picture))
    }

    /// Takes the image of what was pinned too early, once it is whole; none where the document is another by then.
    pub fn retake_snapshot(&mut self) {
        let (is_whole, document) = (self.has_whole_picture(), &self.document);
        let is_over = |(_, pinned): &mut (PathBuf, Document)| is_whole || pinned != document;
        if let Some((path, pinned)) = self.shared.snapshots.unfinished.take_if(is_over)
            && pinned == self.document
        {
            self.change_snapshots(Change::Retake(path));
        }
    }

    /// Brings a pinned state back: an edit like others.
    pub fn use_snapshot(&mut self, path: &Path) {
        let mut pinned = self.shared.snapshots.entries.iter();
        if let Some((pinned, _)) = pinned.find(|(pinned, _)| pinned.path == path) {
            self.replace_document(pinned.document.clone(), format!("Bring back {}", pinned.name));
        }
    }
}
