//! Loading files for the window. The result is reported; the current render continues.

use std::path::PathBuf;

use super::State;
use crate::panics::{caught, lock};
use crate::render::error::SessionError;
use crate::render::worker::{Activity, Event, Level};
use crate::scene::environment::{EnvironmentEncoding, EnvironmentSource};
use crate::scene::{ModelOptions, ModelSource};

impl State<'_> {
    pub(super) fn load_model(&mut self, source: ModelSource, options: ModelOptions) {
        self.begin_loading(source.to_string());
        let path = PathBuf::from(source.to_string());
        self.loaded(path, |state| {
            let model = state.session()?.assets().model(&source, &options)?;
            Ok(Event::ModelOpened(source, options, model))
        });
    }

    pub(super) fn load_environment(&mut self, source: EnvironmentSource) {
        self.begin_loading(source.to_string());
        let path = PathBuf::from(source.to_string());
        self.loaded(path, |state| {
            let environment = state
                .session()?
                .assets()
                .environment(&source, EnvironmentEncoding::default())?;
            for warning in &environment.warnings {
                state.message(Level::Warning, warning.clone());
            }
            Ok(Event::EnvironmentOpened(source, environment))
        });
    }

    /// Reads the scene's files again and restarts the render.
    pub(super) fn reload(&mut self) {
        let Some(document) = self.stage.as_ref().map(|stage| stage.submission.document.clone()) else {
            lock(&self.shared.events).push(Event::Reloaded(None, None));
            return;
        };
        let mut is_read = false;
        self.begin_loading(document.model.to_string());
        self.loaded(PathBuf::from(document.model.to_string()), |state| {
            let reloaded = state.session()?.reload(&document)?;
            if let Some(summary) = reloaded.model.report.summary() {
                state.message(Level::Warning, summary);
            }
            is_read = true;
            Ok(Event::Reloaded(reloaded.before, Some(reloaded.model)))
        });
        if is_read {
            self.restart();
        }
    }

    /// Reports the start of loading and resets its cancellation.
    pub(super) fn begin_loading(&mut self, what: String) {
        self.assets.loading().begin();
        self.report(Activity::Loading(what));
    }

    /// Reports the result of loading; a failure does not affect the current render.
    fn loaded(&mut self, path: PathBuf, work: impl FnOnce(&mut Self) -> Result<Event, SessionError>) {
        let event = match caught(|| work(self)) {
            Ok(Ok(event)) => event,
            Ok(Err(error)) if error.is_cancelled() => Event::OpenFailed(path, Level::Info, error.to_string()),
            Ok(Err(error)) => Event::OpenFailed(path, Level::Error, error.to_string()),
            Err(panic) => {
                let why = format!("{}: reading it failed: {panic}", path.display());
                Event::OpenFailed(path, Level::Error, why)
            }
        };
        lock(&self.shared.events).push(event);
        (self.repaint)();
    }
}
