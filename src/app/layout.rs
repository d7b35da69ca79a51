//! The panels and how they are docked.

use egui::{Color32, Stroke, Ui, Visuals, WidgetText};
use egui_tiles::{
    Behavior, Container, Linear, LinearDir, ResizeState, SimplificationOptions, TabState, Tabs, TileId, Tiles, Tree,
    UiResponse,
};
use serde::{Deserialize, Serialize};

use super::panels::{self, Desk};
use super::theme;
use super::viewport::Viewport;

/// A panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Pane {
    /// The picture.
    Viewport,
    /// The material's parameters.
    Material,
    /// The geometric lobe's curve.
    Curve,
    /// What the lobe draws.
    Samples,
    /// The lobe itself.
    Lobe,
    /// Error against time.
    Convergence,
    /// Environment, background, ground.
    Lighting,
    /// Camera, view and render settings.
    Camera,
    /// Materials to start from.
    Presets,
    /// Pinned states.
    Snapshots,
    /// What was said.
    Log,
    /// The proof on this machine.
    Check,
    /// What is simulated, why, and what it costs.
    Effects,
    /// Techniques against each other.
    Race,
}

impl Pane {
    /// All of them.
    pub const ALL: [Self; 14] = [
        Self::Viewport,
        Self::Material,
        Self::Curve,
        Self::Samples,
        Self::Lobe,
        Self::Convergence,
        Self::Lighting,
        Self::Camera,
        Self::Presets,
        Self::Snapshots,
        Self::Log,
        Self::Check,
        Self::Effects,
        Self::Race,
    ];

    /// What it is called.
    pub fn title(self) -> &'static str {
        match self {
            Self::Viewport => "Viewport",
            Self::Material => "Material",
            Self::Curve => "Curve",
            Self::Samples => "Samples",
            Self::Lobe => "Lobe",
            Self::Convergence => "Convergence",
            Self::Lighting => "Light",
            Self::Camera => "Camera & picture",
            Self::Presets => "Presets",
            Self::Snapshots => "Snapshots",
            Self::Log => "Log",
            Self::Check => "Check",
            Self::Effects => "Effects",
            Self::Race => "Race",
        }
    }

    /// What bringing it to the front is called.
    pub(super) fn command(self) -> String {
        format!("Show {}", self.title().to_lowercase())
    }
}

/// Shares of the window's width.
const LEFT_SHARE: f32 = 0.19;
const RIGHT_SHARE: f32 = 0.25;

/// The layout at first: presets over light and camera on the left, the picture, the material over its plots on the right.
pub(super) fn default_layout() -> Tree<Pane> {
    let mut tiles = Tiles::default();
    let mut pane = |pane| tiles.insert_pane(pane);
    let (viewport, material) = (pane(Pane::Viewport), pane(Pane::Material));
    let upper_left = [Pane::Presets, Pane::Snapshots, Pane::Log, Pane::Check]
        .map(&mut pane)
        .to_vec();
    let lower_left = [Pane::Lighting, Pane::Camera, Pane::Effects, Pane::Race]
        .map(&mut pane)
        .to_vec();
    let lower_right = [Pane::Curve, Pane::Samples, Pane::Lobe, Pane::Convergence].map(&mut pane);
    let upper_left = tiles.insert_tab_tile(upper_left);
    let lower_left = tiles.insert_tab_tile(lower_left);
    let left = tiles.insert_container(Linear::new_binary(LinearDir::Vertical, [upper_left, lower_left], 0.42));
    let upper_right = tiles.insert_tab_tile(vec![material]);
    let lower_right = tiles.insert_tab_tile(lower_right.to_vec());
    let right = tiles.insert_container(Linear::new_binary(
        LinearDir::Vertical,
        [upper_right, lower_right],
        0.56,
    ));
    let mut across = Linear::new(LinearDir::Horizontal, vec![left, viewport, right]);
    across.shares.set_share(left, LEFT_SHARE);
    across.shares.set_share(viewport, 1.0 - LEFT_SHARE - RIGHT_SHARE);
    across.shares.set_share(right, RIGHT_SHARE);
    let root = tiles.insert_container(across);
    Tree::new(egui::Id::unique("panels"), root, tiles)
}

/// Whether every panel is in a layout that was read from disk: one of an older version may lack some.
pub(super) fn is_complete(tree: &Tree<Pane>) -> bool {
    Pane::ALL.iter().all(|pane| tree.tiles.find_pane(pane).is_some())
}

/// Brings a panel to the front.
pub(super) fn reveal(tree: &mut Tree<Pane>, pane: Pane) {
    tree.make_active(|_, tile| matches!(tile, egui_tiles::Tile::Pane(of) if *of == pane));
}

/// Shows panes.
pub(super) struct Panes<'a, 'd> {
    pub(super) desk: &'a mut Desk<'d>,
    pub(super) viewport: &'a mut Viewport,
}

impl Behavior<Pane> for Panes<'_, '_> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile_id: TileId, pane: &mut Pane) -> UiResponse {
        if *pane == Pane::Viewport {
            self.viewport.show(ui, self.desk);
            return UiResponse::None;
        }
        ui.painter().rect_filled(ui.max_rect(), 0.0, ui.visuals().panel_fill);
        egui::ScrollArea::vertical()
            .id_salt(pane.title())
            .auto_shrink(false)
            .show(ui, |ui| {
                let frame = egui::Frame::new().inner_margin(theme::PANEL_MARGIN);
                frame.show(ui, |ui| match pane {
                    Pane::Material => panels::material::show(ui, self.desk),
                    Pane::Curve => panels::curve::show(ui, self.desk),
                    Pane::Samples => panels::samples::show(ui, self.desk),
                    Pane::Lobe => panels::lobe::show(ui, self.desk),
                    Pane::Convergence => panels::convergence::show(ui, self.desk),
                    Pane::Lighting => panels::lighting::show(ui, self.desk),
                    Pane::Camera => panels::camera::show(ui, self.desk),
                    Pane::Presets => panels::presets::show(ui, self.desk),
                    Pane::Snapshots => panels::snapshots::show(ui, self.desk),
                    Pane::Log => panels::log::show(ui, self.desk),
                    Pane::Check => panels::check::show(ui, self.desk),
                    Pane::Effects => panels::effects::show(ui, self.desk),
                    Pane::Race => panels::race::show(ui, self.desk),
                    Pane::Viewport => {}
                });
            });
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> WidgetText {
        pane.title().into()
    }

    fn tab_bar_height(&self, _style: &egui::Style) -> f32 {
        theme::BAR_HEIGHT
    }

    fn gap_width(&self, _style: &egui::Style) -> f32 {
        3.0
    }

    fn min_size(&self) -> f32 {
        140.0
    }

    fn tab_title_spacing(&self, _visuals: &Visuals) -> f32 {
        10.0
    }

    fn tab_bar_color(&self, visuals: &Visuals) -> Color32 {
        theme::ground(visuals.dark_mode)
    }

    fn tab_outline_stroke(&self, _: &Visuals, _: &Tiles<Pane>, _: TileId, _: &TabState) -> Stroke {
        Stroke::NONE
    }

    fn tab_bar_hline_stroke(&self, _visuals: &Visuals) -> Stroke {
        Stroke::NONE
    }

    fn resize_stroke(&self, style: &egui::Style, state: ResizeState) -> Stroke {
        let color = match state {
            ResizeState::Idle => theme::ground(style.visuals.dark_mode),
            ResizeState::Hovering | ResizeState::Dragging => theme::accent(style.visuals.dark_mode),
        };
        Stroke::new(self.gap_width(style), color)
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions {
            all_panes_must_have_tabs: false,
            prune_single_child_tabs: false,
            ..SimplificationOptions::default()
        }
    }

    fn is_tab_bar_visible(&self, _tile_id: TileId, _tabs: &Tabs) -> bool {
        true
    }
}

/// The tile that holds the picture.
pub(super) fn viewport_tile(tree: &Tree<Pane>) -> Option<TileId> {
    tree.tiles.find_pane(&Pane::Viewport)
}

/// Hides all panels but the picture, or shows them.
pub(super) fn set_maximised(tree: &mut Tree<Pane>, is_maximised: bool) {
    let Some(root) = tree.root() else { return };
    let viewport = viewport_tile(tree);
    let others: Vec<TileId> = match tree.tiles.get_container(root) {
        Some(Container::Linear(linear)) => linear.children.to_vec(),
        _ => Vec::new(),
    };
    for tile in others.into_iter().filter(|tile| Some(*tile) != viewport) {
        tree.set_visible(tile, !is_maximised);
    }
}
