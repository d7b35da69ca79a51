//! What a panic leaves: the copy of the unsaved document, and a report of what happened.
//!
//! Every window has a witness that knows its document as the last frame left it, and what was done before. A hook writes
//! both when any thread panics, before the thread unwinds: the next start offers them.

use std::{
    collections::VecDeque,
    fs::OpenOptions,
    io::Write as _,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, MutexGuard, TryLockError, Weak},
    thread::ThreadId,
};

use crate::{document::Document, panics, panics::lock, store::FileError, store::recovery};

/// Most actions that a report lists.
const ACTIONS: usize = 40;
/// Longest line about one of them, characters.
const ACTION_LENGTH: usize = 160;

/// The witnesses of all windows.
static WITNESSES: Mutex<Vec<Weak<Mutex<Known>>>> = Mutex::new(Vec::new());

/// What a window records in case something panics.
#[derive(Clone)]
pub struct Witness(Arc<Mutex<Known>>);

pub struct Known {
    /// The document where it is unsaved, and the file that it belongs to.
    unsaved: Option<(Document, Option<PathBuf>)>,
    /// Where the copy goes; a report stands beside it. `None` where nothing is saved for recovery.
    pub copy: Option<PathBuf>,
    /// What renders.
    pub engine: String,
    /// What was done last, with how often in a row; the latest last.
    actions: VecDeque<(String, u32)>,
    /// What is to be said in the window of panics in threads beside it.
    pub reported: Vec<String>,
    /// Whose panic ends the window.
    window: ThreadId,
}

impl Default for Witness {
    fn default() -> Self {
        let known = Arc::new(Mutex::new(Known {
            unsaved: None,
            copy: None,
            engine: "none yet".to_owned(),
            actions: VecDeque::new(),
            reported: Vec::new(),
            window: std::thread::current().id(),
        }));
        let mut all = lock(&WITNESSES);
        all.retain(|witness| witness.strong_count() > 0);
        all.push(Arc::downgrade(&known));
        Self(known)
    }
}

impl Witness {
    pub fn known(&self) -> MutexGuard<'_, Known> {
        lock(&self.0)
    }

    /// Takes the document as the frame left it.
    pub fn see(&self, document: &Document, project: Option<&Path>, is_saved: bool) {
        let known = &mut *self.known();
        let is_known = |(kept, of): &(Document, Option<PathBuf>)| kept == document && of.as_deref() == project;
        if is_saved {
            known.unsaved = None;
        } else if !known.unsaved.as_ref().is_some_and(is_known) {
            known.unsaved = Some((document.clone(), project.map(Path::to_owned)));
        }
    }

    /// Records an action.
    pub fn note(&self, action: impl Into<String>) {
        let action: String = action.into().chars().take(ACTION_LENGTH).collect();
        let actions = &mut self.known().actions;
        match actions.back_mut() {
            Some((last, count)) if *last == action => *count += 1,
            _ => actions.push_back((action, 1)),
        }
        if actions.len() > ACTIONS {
            actions.pop_front();
        }
    }
}

/// Has panics of any thread put unsaved documents aside and write a report, from now on. To be called once.
pub fn report_panics() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if !panics::is_contained() {
            let all = WITNESSES.try_lock().map_or_else(|_| Vec::new(), |all| all.clone());
            all.iter()
                .filter_map(Weak::upgrade)
                .for_each(|known| testify(&known, panic));
        }
        usual(panic);
    }));
}

fn testify(known: &Mutex<Known>, panic: &std::panic::PanicHookInfo<'_>) {
    let mut known = match known.try_lock() {
        Ok(known) => known,
        Err(TryLockError::Poisoned(known)) => known.into_inner(),
        // The panicking thread itself holds the lock: nothing can be read.
        Err(TryLockError::WouldBlock) => return,
    };
    let Some(copy) = known.copy.clone() else { return };
    let unsaved = known.unsaved.as_ref();
    let save = |(document, project): &(Document, Option<PathBuf>)| {
        recovery::save_for_recovery(&copy, document, project.as_deref()).err()
    };
    let failure = unsaved.and_then(save);
    let report = recovery::report_path(&copy);
    let text = report_text(&known, panic, failure);
    let file = OpenOptions::new().create(true).append(true).open(&report);
    let written = file.and_then(|mut file| file.write_all(text.as_bytes()).and_then(|()| file.sync_all()));
    let thread = std::thread::current();
    if thread.id() != known.window {
        let place = match written {
            Ok(()) => format!("{} has more", report.display()),
            Err(error) => format!("no report could be written: {error}"),
        };
        let name = thread.name().unwrap_or("a thread without a name");
        let what = panics::message(panic.payload());
        let text = format!("an internal error in \"{name}\": {what}; {place}");
        known.reported.push(text);
    }
}

/// The report; [`recovery::RecoveryFile::report`] finds the line of the message.
fn report_text(known: &Known, panic: &std::panic::PanicHookInfo<'_>, failure: Option<FileError>) -> String {
    let thread = std::thread::current();
    let thread = thread.name().unwrap_or("without a name");
    let (system, architecture) = (std::env::consts::OS, std::env::consts::ARCH);
    let message = panics::message(panic.payload()).replace('\n', " ");
    let version = env!("CARGO_PKG_VERSION");
    let mut text = format!(
        "Glossmith: {version}\nSystem: {system} {architecture}\nEngine: {}\n",
        known.engine
    );
    text += &format!("Thread: {thread}\n{}: {message}\n", recovery::MESSAGE);
    if let Some(place) = panic.location() {
        text += &format!("Place: {place}\n");
    }
    if let Some(failure) = failure {
        text += &format!("The document could not be saved for recovery: {failure}\n");
    }
    text += "Done last: \n";
    for (action, count) in &known.actions {
        text += &match count {
            1 => format!("  : {action}\n"),
            count => format!("  : {action} × {count}\n"),
        };
    }
    text + &format!("Backtrace: \n{}\n\n", std::backtrace::Backtrace::force_capture())
}
