//! Unsaved edits are saved for recovery every few seconds, on a thread of their own, and offered again after a crash.

use std::{
    path::{Path, PathBuf},
    sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel},
    time::{Duration, Instant},
};

use crate::{
    document::Document,
    services::crash::Witness,
    store::FileError,
    store::recovery::{self, Recovered, RecoveryFile},
};

/// Shortest time between two copies of a document that keeps changing.
pub const INTERVAL: Duration = Duration::from_secs(5);
/// After how long the thread looks again for what crashes left; each time twice as long. A process that is killed goes on
/// holding its file while its memory and its GPU are taken back.
const LOOK_AGAIN: Duration = Duration::from_secs(1);
/// How long the window waits for the thread to end when it is closed.
const FAREWELL: Duration = Duration::from_secs(2);

/// The file for this window's unsaved edits, and the thread that writes it.
#[derive(Default)]
pub struct Autosave {
    /// `None` where nothing is saved for recovery.
    orders: Option<Sender<Order>>,
    reports: Option<Receiver<Report>>,
    interval: Duration,
    /// What the file is to hold.
    kept: Option<Document>,
    kept_at: Option<Instant>,
    /// What a panic puts aside.
    pub witness: Witness,
}

type Order = Box<dyn FnOnce(&mut Files) -> Result<(), FileError> + Send>;
/// What crashes left, or what can't be written or removed.
type Report = Result<Vec<Leftover>, FileError>;

/// What the thread has.
struct Files {
    own: RecoveryFile,
    leftovers: Vec<Option<RecoveryFile>>,
    is_empty: bool,
    /// The last document could be written.
    is_kept: bool,
}

/// Something that a crash left.
pub struct Leftover {
    /// For [`Autosave::discard`].
    pub index: usize,
    /// The document, or why it can't be read; `None` where a panic left nothing but its report.
    pub contents: Option<Result<Recovered, String>>,
    /// What a panic wrote.
    pub report: Option<recovery::Report>,
}

impl Autosave {
    /// Starts to put documents aside in a folder, and looks for what crashes left there.
    pub fn begin(folder: PathBuf, interval: Duration, ctx: egui::Context) -> std::io::Result<Self> {
        let (orders, ordered) = channel();
        let (sender, reports) = channel();
        let witness = Witness::default();
        let its_witness = witness.clone();
        std::thread::Builder::new().name("autosave".to_owned()).spawn(move || {
            let report = |report| {
                // Nobody listens where the window was closed meanwhile.
                let _ = sender.send(report);
                ctx.request_repaint();
            };
            if let Err(error) = work(&folder, &its_witness, &ordered, &report) {
                report(Err(error));
            }
        })?;
        Ok(Self {
            orders: Some(orders),
            reports: Some(reports),
            interval,
            kept: None,
            kept_at: None,
            witness,
        })
    }

    /// What the thread reported since this was last called.
    pub fn take_reports(&self) -> Vec<Report> {
        self.reports.iter().flat_map(Receiver::try_iter).collect()
    }

    /// Takes the document as the frame left it. Returns after how long to be called again, where something is still to
    /// be saved.
    pub fn watch(&mut self, document: &Document, project: Option<&Path>, is_saved: bool) -> Option<Duration> {
        self.witness.see(document, project, is_saved);
        if is_saved {
            if self.kept.is_some() {
                self.end();
            }
            return None;
        }
        if self.orders.is_none() || self.kept.as_ref() == Some(document) {
            return None;
        }
        let since = self.kept_at.map_or(Duration::MAX, |at| at.elapsed());
        if since < self.interval {
            return Some(self.interval - since);
        }
        self.keep(document, project);
        None
    }

    /// Puts a document aside at once. The channel closes when that is done.
    pub fn keep(&mut self, document: &Document, project: Option<&Path>) -> Receiver<()> {
        let (kept, project) = (document.clone(), project.map(Path::to_owned));
        let (open, done) = channel();
        self.order(move |files| {
            let _open = open;
            let saved = files.own.save(&kept, project.as_deref());
            (files.is_kept, files.is_empty) = (saved.is_ok(), false);
            saved
        });
        self.kept = Some(document.clone());
        self.kept_at = Some(Instant::now());
        done
    }

    /// Removes a leftover, once everything saved before has been written; not where its contents, restored and saved again,
    /// could not be.
    pub fn discard(&self, index: usize) {
        self.order(move |files| {
            let leftover = files.leftovers.get_mut(index).filter(|_| files.is_kept);
            leftover.and_then(Option::take).map_or(Ok(()), RecoveryFile::remove)
        });
    }

    /// Nothing is left: the document is saved, or the window is closed as it should be.
    pub fn end(&mut self) {
        self.kept = None;
        self.order(|files| {
            files.is_empty = true;
            files.own.clear()
        });
    }

    fn order(&self, order: impl FnOnce(&mut Files) -> Result<(), FileError> + Send + 'static) {
        if let Some(orders) = &self.orders {
            // The thread is gone where there is no file to write to, which has been said.
            let _ = orders.send(Box::new(order));
        }
    }
}

impl Drop for Autosave {
    /// Lets the thread finish its orders, and leaves it behind where that takes long.
    fn drop(&mut self) {
        if std::thread::panicking() {
            // The window ends by this panic: its file stays for the next start.
            std::mem::forget(self.orders.take());
            return;
        }
        self.orders = None;
        // The thread drops the other end when it is done.
        if let Some(reports) = &self.reports {
            while reports.recv_timeout(FAREWELL).is_ok() {}
        }
    }
}

/// Says what crashes left and carries out orders until the window is gone.
fn work(folder: &Path, witness: &Witness, ordered: &Receiver<Order>, report: &dyn Fn(Report)) -> Result<(), FileError> {
    let look = |files: &mut Files| -> Result<(), FileError> {
        let load = |(at, file): (usize, &RecoveryFile)| Leftover {
            index: files.leftovers.len() + at,
            contents: file.has_document().then(|| file.load().map_err(crate::in_words)),
            report: file.report(),
        };
        let found = recovery::leftovers(folder)?;
        if !found.is_empty() {
            report(Ok(found.iter().enumerate().map(load).collect()));
        }
        files.leftovers.extend(found.into_iter().map(Some));
        Ok(())
    };
    let mut files = Files {
        own: RecoveryFile::open(folder)?,
        leftovers: Vec::new(),
        is_empty: true,
        is_kept: true,
    };
    look(&mut files)?;
    witness.known().copy = Some(files.own.path().to_owned());
    let mut has_failed = false;
    let mut wait = LOOK_AGAIN;
    loop {
        let done = match ordered.recv_timeout(wait) {
            Ok(order) => order(&mut files),
            Err(RecvTimeoutError::Timeout) => {
                wait *= 2;
                look(&mut files)
            }
            Err(RecvTimeoutError::Disconnected) => break,
        };
        let fails = done.is_err();
        // Said once, not every few seconds for as long as a disk is full.
        if let (Err(error), false) = (done, has_failed) {
            report(Err(error));
        }
        has_failed = fails;
    }
    if files.is_empty
        && let Err(error) = files.own.remove()
    {
        log::debug!("{error}");
    }
    Ok(())
}
