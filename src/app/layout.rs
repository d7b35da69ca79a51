//! The panels and how they are docked.

use egui::{Color32, Response, Sense, Stroke, TextStyle, Ui, Vec2, Visuals, WidgetText};
use egui_tiles::{
    Behavior, Container, Linear, LinearDir, ResizeState, SimplificationOptions, TabState, Tabs, Tile, TileId, Tiles,
    Tree, UiResponse,
};

pub use crate::pane::Pane;
use crate::{
    actions::Action, desk::Desk, kit::theme, pane::Home, panels::Panels, sheets::book::help_button, viewport::Viewport,
};

/// Shares of the window's width: at 1366 points all tabs fit.
const LEFT_SHARE: f32 = 0.205;
const RIGHT_SHARE: f32 = 0.25;

/// To either side of a tab's title, points.
const TAB_SPACING: f32 = 7.0;
/// Width of the button of the manual behind the tabs, and of that for more of them, points.
const HELP_WIDTH: f32 = 24.0;
const MORE_WIDTH: f32 = 34.0;

/// Panels in which the look is made: those that are open in *Look*.
const LOOK_PANES: [Pane; 8] = [
    Pane::Viewport,
    Pane::Presets,
    Pane::Scene,
    Pane::Snapshots,
    Pane::Lighting,
    Pane::Camera,
    Pane::Material,
    Pane::Curve,
];

/// The layout of *Look*: presets over light and camera on the left, the image, the material on the right.
pub fn to_look() -> Tree<Pane> {
    let mut tree = all_docked();
    let place = |pane| tree.tiles.find_pane(&pane);
    let tabs = place(Pane::Material).and_then(|material| tree.tiles.parent_of(material));
    if let Some((curve, tabs)) = place(Pane::Curve).zip(tabs) {
        tree.move_tile_to_container(curve, tabs, 1, false);
    }
    for pane in Pane::ALL.into_iter().filter(|pane| !LOOK_PANES.contains(pane)) {
        close(&mut tree, pane);
    }
    for pane in [Pane::Presets, Pane::Lighting, Pane::Material] {
        reveal(&mut tree, pane);
    }
    tree
}

/// The layout of *Measure*: every panel, effects and convergence in front.
pub fn to_measure() -> Tree<Pane> {
    let mut tree = all_docked();
    for pane in [Pane::Effects, Pane::Convergence] {
        reveal(&mut tree, pane);
    }
    tree
}

/// All panels where they are docked at first.
fn all_docked() -> Tree<Pane> {
    let mut tiles = Tiles::default();
    let mut tabs = |home: Home| {
        let panes: Vec<TileId> = panes_of(home).map(|pane| tiles.insert_pane(pane)).collect();
        tiles.insert_tab_tile(panes)
    };
    let [upper_left, lower_left, upper_right, lower_right] =
        [Home::UpperLeft, Home::LowerLeft, Home::UpperRight, Home::LowerRight].map(&mut tabs);
    let viewport = tiles.insert_pane(Pane::Viewport);
    let mut over =
        |upper, lower, share| tiles.insert_container(Linear::new_binary(LinearDir::Vertical, [upper, lower], share));
    let left = over(upper_left, lower_left, 0.42);
    let right = over(upper_right, lower_right, 0.56);
    let mut across = Linear::new(LinearDir::Horizontal, vec![left, viewport, right]);
    across.shares.set_share(left, LEFT_SHARE);
    across.shares.set_share(viewport, 1.0 - LEFT_SHARE - RIGHT_SHARE);
    across.shares.set_share(right, RIGHT_SHARE);
    let root = tiles.insert_container(across);
    Tree::new(egui::Id::unique("panels"), root, tiles)
}

/// The panels that are docked in one place at first.
fn panes_of(home: Home) -> impl Iterator<Item = Pane> {
    Pane::ALL.into_iter().filter(move |pane| pane.home() == Some(home))
}

/// Puts the panels that a layout lacks beside those that they are docked with at first: one that was read from disk may
/// be of a version that did not have them yet. `None` where the image is missing.
pub fn complete(mut tree: Tree<Pane>) -> Option<Tree<Pane>> {
    viewport_tile(&tree)?;
    for pane in Pane::ALL {
        if tree.tiles.find_pane(&pane).is_some() {
            continue;
        }
        let mut neighbors = panes_of(pane.home()?);
        let beside = neighbors.find_map(|neighbor| tree.tiles.parent_of(tree.tiles.find_pane(&neighbor)?));
        let tabs = beside.or(tree.root())?;
        let tile = tree.tiles.insert_pane(pane);
        tree.move_tile_to_container(tile, tabs, usize::MAX, false);
    }
    Some(tree)
}

/// Brings a panel to the front, opened where it was closed.
pub fn reveal(tree: &mut Tree<Pane>, pane: Pane) {
    set_open(&mut tree.tiles, pane, true);
    tree.make_active(|_, tile| matches!(tile, egui_tiles::Tile::Pane(of) if *of == pane));
}

/// Whether a panel has not been closed.
pub fn is_open(tree: &Tree<Pane>, pane: Pane) -> bool {
    tree.tiles
        .find_pane(&pane)
        .is_some_and(|tile| tree.tiles.is_visible(tile))
}

pub fn close(tree: &mut Tree<Pane>, pane: Pane) {
    set_open(&mut tree.tiles, pane, false);
}

/// Opens or closes a panel where it is docked; what is left without an open panel closes, too.
fn set_open(tiles: &mut Tiles<Pane>, pane: Pane, is_open: bool) {
    let Some(mut tile) = tiles.find_pane(&pane) else { return };
    tiles.set_visible(tile, is_open);
    while let Some(parent) = tiles.parent_of(tile)
        && let Some(container) = tiles.get_container(parent)
    {
        let is_used = container.children().any(|child| tiles.is_visible(*child));
        tiles.set_visible(parent, is_used);
        tile = parent;
    }
}

/// The open panels of a tile.
fn panes(tiles: &Tiles<Pane>, tile: TileId) -> Vec<Pane> {
    match tiles.get(tile) {
        Some(Tile::Pane(pane)) if tiles.is_visible(tile) => vec![*pane],
        Some(Tile::Container(container)) => container.children().flat_map(|child| panes(tiles, *child)).collect(),
        _ => Vec::new(),
    }
}

fn title(tiles: &Tiles<Pane>, tile: TileId) -> String {
    let titles: Vec<&str> = panes(tiles, tile).into_iter().map(Pane::title).collect();
    titles.join(" | ")
}

/// The tabs for which there is no room: behind the others they would be cut off in the middle of a word, and stand in a
/// menu instead. The tab in front always has room.
pub fn hidden_tabs(ui: &Ui, tree: &Tree<Pane>) -> Vec<TileId> {
    let tiles = &tree.tiles;
    let of_bar = |(bar, tile): (&TileId, &Tile<Pane>)| {
        let Tile::Container(Container::Tabs(tabs)) = tile else {
            return Vec::new();
        };
        let is_front = |tile: &TileId| tabs.active == Some(*tile);
        let font = TextStyle::Button.resolve(ui.style());
        let width = |tile: TileId| {
            let text = ui
                .painter()
                .layout_no_wrap(title(tiles, tile), font.clone(), Color32::PLACEHOLDER);
            text.size().x + 2.0 * TAB_SPACING
        };
        let mut open = tabs.children.clone();
        open.retain(|tile| tiles.is_visible(*tile));
        let room = tiles.rect(*bar).map_or(f32::INFINITY, |rect| rect.width() - HELP_WIDTH);
        if open.iter().map(|tile| width(*tile)).sum::<f32>() <= room {
            return Vec::new();
        }
        open.sort_by_key(|tile| !is_front(tile));
        let mut taken = MORE_WIDTH;
        open.retain(|tile| {
            let after = taken + width(*tile);
            let is_hidden = after > room && !is_front(tile);
            if !is_hidden {
                taken = after;
            }
            is_hidden
        });
        open
    };
    tiles.iter().flat_map(of_bar).collect()
}

/// Shows panes.
pub struct Panes<'a, 'd> {
    pub desk: &'a mut Desk<'d>,
    pub panels: &'a mut Panels,
    pub viewport: &'a mut Viewport,
    /// See [`hidden_tabs`].
    pub hidden: Vec<TileId>,
}

impl Panes<'_, '_> {
    /// The menu of the tabs for which there is no room.
    fn more_tabs(&mut self, tiles: &Tiles<Pane>, ui: &mut Ui, tabs: &Tabs) {
        let mut hidden = tabs.children.clone();
        hidden.retain(|tile| self.hidden.contains(tile));
        if hidden.is_empty() {
            return;
        }
        let button = ui.menu_button("…", |ui| {
            for tile in &hidden {
                let chosen = ui.button(title(tiles, *tile)).clicked();
                let first = panes(tiles, *tile).into_iter().take(usize::from(chosen));
                self.desk.actions.extend(first.map(Action::Reveal));
            }
        });
        let front = tabs.active.map_or_else(String::new, |tile| title(tiles, tile));
        let button = button.response.on_hover_text("Panels for whose tabs there is no room");
        button.accessible_name(format!("More panels beside {front}"));
    }
}

/// Draws the tabs for which there is room.
struct TabsWithRoom;

impl Behavior<Pane> for TabsWithRoom {
    fn pane_ui(&mut self, _: &mut Ui, _: TileId, _: &mut Pane) -> UiResponse {
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> WidgetText {
        pane.title().into()
    }

    fn tab_title_for_tile(&mut self, tiles: &Tiles<Pane>, tile: TileId) -> WidgetText {
        title(tiles, tile).into()
    }

    fn tab_title_spacing(&self, _: &Visuals) -> f32 {
        TAB_SPACING
    }

    fn tab_outline_stroke(&self, _: &Visuals, _: &Tiles<Pane>, _: TileId, _: &TabState) -> Stroke {
        Stroke::NONE
    }
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
                frame.show(ui, |ui| self.panels.show(*pane, ui, self.desk));
            });
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> WidgetText {
        pane.title().into()
    }

    fn tab_title_for_tile(&mut self, tiles: &Tiles<Pane>, tile_id: TileId) -> WidgetText {
        title(tiles, tile_id).into()
    }

    fn top_bar_right_ui(&mut self, tiles: &Tiles<Pane>, ui: &mut Ui, _: TileId, tabs: &Tabs, _: &mut f32) {
        let active = tabs.active.and_then(|tile| tiles.get(tile));
        if let Some(Tile::Pane(pane)) = active {
            // Nothing stands at the very edge.
            ui.add_space(6.0);
            help_button(ui, pane.title(), pane.manual());
        }
        self.more_tabs(tiles, ui, tabs);
    }

    fn tab_ui(
        &mut self,
        tiles: &mut Tiles<Pane>,
        ui: &mut Ui,
        id: egui::Id,
        tile: TileId,
        state: &TabState,
    ) -> Response {
        match self.hidden.contains(&tile) {
            true => ui.allocate_response(Vec2::ZERO, Sense::hover()),
            false => TabsWithRoom.tab_ui(tiles, ui, id, tile, state),
        }
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

    fn tab_bar_color(&self, visuals: &Visuals) -> Color32 {
        theme::ground(visuals.dark_mode)
    }

    fn tab_bar_hline_stroke(&self, _visuals: &Visuals) -> Stroke {
        Stroke::NONE
    }

    fn resize_stroke(&self, style: &egui::Style, state: ResizeState) -> Stroke {
        let color = match state {
            ResizeState::Idle => theme::ground(style.visuals.dark_mode),
            ResizeState::Hovering | ResizeState::Dragging => style.visuals.hyperlink_color,
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

/// The tile that holds the image.
pub fn viewport_tile(tree: &Tree<Pane>) -> Option<TileId> {
    tree.tiles.find_pane(&Pane::Viewport)
}

/// The panel that is seen at a point of the window.
pub fn pane_at(tree: &Tree<Pane>, at: egui::Pos2) -> Option<Pane> {
    let is_there =
        |tile: TileId| tree.tiles.is_visible(tile) && tree.tiles.rect(tile).is_some_and(|rect| rect.contains(at));
    let mut all = Pane::ALL.into_iter();
    all.find(|pane| tree.tiles.find_pane(pane).is_some_and(is_there))
}

/// Hides all panels but the image, or shows them.
pub fn set_maximised(tree: &mut Tree<Pane>, is_maximised: bool) {
    let root = tree.root().and_then(|root| tree.tiles.get_container(root));
    let mut others = match root {
        Some(Container::Linear(linear)) => linear.children.clone(),
        _ => Vec::new(),
    };
    others.retain(|tile| Some(*tile) != viewport_tile(tree));
    for tile in others {
        tree.set_visible(tile, !is_maximised);
    }
}
