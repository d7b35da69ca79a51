//! Unsaved edits are saved for recovery every few seconds, on a thread of their own, and offered again after a crash.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::app::services::crash::Witness;
use crate::document::Document;
use crate::store::FileError;
use crate::store::recovery::{self, Recovered, RecoveryFile};

/// Shortest time between two copies of a document that keeps changing.
pub const INTERVAL: Duration = Duration::from_secs(5);
/// How long the window waits for the thread to end when it is closed.
const FAREWELL: Duration = Duration::from_secs(2);

/// The file for this window's unsaved edits, and the thread that writes it.
#[derive(Default)]
pub struct Autosave {
    /// `None` where nothing is saved for recovery.
    orders: Option<Sender<Order>>,
    reports: Option<Receiver<Report>>,
    thread: Option<JoinHandle<()>>,
    interval: Duration,
    /// What the file is to hold.
    kept: Option<Document>,
    kept_at: Option<Instant>,
    /// What a panic puts aside.
    pub witness: Witness,
}

enum Order {
    Keep(Box<Document>, Option<PathBuf>),
    Forget,
    /// A leftover goes, unless its contents, restored and saved again, could not be written.
    Discard(usize),
}

/// A report of the thread.
pub enum Report {
    /// What crashes left.
    Found(Vec<Leftover>),
    /// Something can't be written or removed.
    Failed(FileError),
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
        let thread = std::thread::Builder::new().name("autosave".to_owned()).spawn(move || {
            let report = |report| {
                // Nobody listens where the window was closed meanwhile.
                let _ = sender.send(report);
                ctx.request_repaint();
            };
            work(&folder, &its_witness, &ordered, &report);
        })?;
        Ok(Self {
            orders: Some(orders),
            reports: Some(reports),
            thread: Some(thread),
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
            if self.kept.take().is_some() {
                self.order(Order::Forget);
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

    /// Puts a document aside at once.
    pub fn keep(&mut self, document: &Document, project: Option<&Path>) {
        self.order(Order::Keep(Box::new(document.clone()), project.map(Path::to_owned)));
        self.kept = Some(document.clone());
        self.kept_at = Some(Instant::now());
    }

    /// Removes a leftover, once everything saved before has been written.
    pub fn discard(&self, index: usize) {
        self.order(Order::Discard(index));
    }

    /// The window is closed as it should be: nothing is left.
    pub fn end(&mut self) {
        self.kept = None;
        self.order(Order::Forget);
    }

    fn order(&self, order: Order) {
        if let Some(orders) = &self.orders {
            // The thread is gone where there is no file to write to, which has been said.
            let _ = orders.send(order);
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
        let begun = Instant::now();
        while let Some(thread) = &self.thread
            && !thread.is_finished()
            && begun.elapsed() < FAREWELL
        {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

fn work(folder: &Path, witness: &Witness, ordered: &Receiver<Order>, report: &dyn Fn(Report)) {
    let begin = || -> Result<_, FileError> {
        let leftovers: Vec<Option<RecoveryFile>> = recovery::leftovers(folder)?.into_iter().map(Some).collect();
        let load = |(index, slot): (usize, &Option<RecoveryFile>)| {
            let slot = slot.as_ref()?;
            let load = || slot.load().map_err(crate::in_words);
            Some(Leftover {
                index,
                contents: slot.has_document().then(load),
                report: slot.report(),
            })
        };
        let found: Vec<Leftover> = leftovers.iter().enumerate().filter_map(load).collect();
        if !found.is_empty() {
            report(Report::Found(found));
        }
        let slot = RecoveryFile::open(folder)?;
        witness.put_copies_at(slot.path());
        Ok((slot, leftovers))
    };
    match begin() {
        Ok((slot, leftovers)) => obey(slot, leftovers, ordered, report),
        Err(error) => report(Report::Failed(error)),
    }
}

/// Carries out orders until the window is gone.
fn obey(
    slot: RecoveryFile,
    mut leftovers: Vec<Option<RecoveryFile>>,
    ordered: &Receiver<Order>,
    report: &dyn Fn(Report),
) {
    let mut is_kept = true;
    let mut is_empty = true;
    let mut has_failed = false;
    for order in ordered {
        let done = match order {
            Order::Keep(document, project) => {
                let saved = slot.save(&document, project.as_deref());
                is_kept = saved.is_ok();
                is_empty = false;
                saved
            }
            Order::Forget => {
                is_empty = true;
                slot.clear()
            }
            Order::Discard(index) => match leftovers.get_mut(index).filter(|_| is_kept).and_then(Option::take) {
                Some(slot) => slot.remove(),
                None => Ok(()),
            },
        };
        // Said once, not every few seconds for as long as a disk is full.
        match done {
            Err(error) if !has_failed => {
                has_failed = true;
                report(Report::Failed(error));
            }
            done => has_failed = done.is_err(),
        }
    }
    if is_empty && let Err(error) = slot.remove() {
        log::debug!("{error}");
    }
}
