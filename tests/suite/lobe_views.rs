//! Views of lobes: their numbers against known ones, their files.

use crate::cli_support::Workplace;
use glossmith::{
    analysis::quadrature::integrate_hemisphere,
    optics::curve::Curve,
    optics::lobe::{
        Horizon, Lobe, lobe_evaluate,
        model::{LobeModel, NORMAL, view_direction},
    },
    plot::lobe_view::{LinePlot, LobeView, ViewKind, lobe_view},
    plot::plot_file,
};

fn lines(kind: ViewKind, lobe: &LobeModel, angles_deg: &[f64]) -> LinePlot {
    match lobe_view(kind, std::slice::from_ref(lobe), angles_deg) {
        LobeView::Lines(plot) => plot,
        other => panic!("{other:?}"),
    }
}

/// The values of a series.
fn values(plot: &LinePlot, quantity: &str) -> Vec<f64> {
    let series = plot.series.iter().find(|series| series.quantity == quantity).unwrap();
    series.points.iter().map(|[_, y]| *y).collect()
}

#[test]
fn albedos_are_the_integrals_of_the_lobes() {
    let absorbing = LobeModel {
        horizon: Horizon::Absorb,
        ..LobeModel::new(Lobe::Geometric, 0.6, Curve::Sqrt)
    };
    let anisotropic = LobeModel {
        anisotropy: 0.6,
        rotation_rad: 0.5,
        ..LobeModel::new(Lobe::Ggx, 0.5, Curve::Smooth)
    };
    let others = [
        (Lobe::Ggx, 1.0),
        (Lobe::Ggx, 0.2),
        (Lobe::Phong, 0.5),
        (Lobe::BlinnPhong, 0.6),
        (Lobe::Lambert, 1.0),
    ];
    let others = others.map(|(lobe, roughness)| LobeModel::new(lobe, roughness, Curve::Smooth));
    for lobe in others.iter().chain([&absorbing, &anisotropic]) {
        let frame = lobe.frame();
        for angle_deg in [0.0_f64, 50.0, 80.0] {
            let wo = view_direction(angle_deg.to_radians());
            let expected = integrate_hemisphere(512, |wi| lobe_evaluate(&lobe.shape(), &frame, NORMAL, wo, wi)[0]);
            let albedo = values(&lines(ViewKind::Albedo, lobe, &[angle_deg]), "albedo")[0];
            near!(albedo, expected, 0.003, "{} {angle_deg}", lobe.name);
        }
    }
}

#[test]
fn reciprocity_holds_for_ggx_and_fails_for_the_geometric_lobe() {
    let angles = [0.0, 30.0, 60.0, 85.0];
    for lobe in [Lobe::Ggx, Lobe::Phong, Lobe::Lambert] {
        let plot = lines(
            ViewKind::Reciprocity,
            &LobeModel::new(lobe, 0.4, Curve::Smooth),
            &angles,
        );
        assert!(values(&plot, "max").into_iter().all(|error| error < 1e-9), "{lobe:?}");
    }
    let plot = lines(
        ViewKind::Reciprocity,
        &LobeModel::new(Lobe::Geometric, 0.4, Curve::Smooth),
        &angles,
    );
    let (rms, max) = (values(&plot, "rms"), values(&plot, "max"));
    assert!(
        rms.iter()
            .zip(&max)
            .all(|(rms, max)| 0.05 < *rms && rms <= max && *max <= 2.0),
        "{rms:?} {max:?}"
    );
}

#[test]
fn csv_has_its_columns_and_every_view_is_drawn() {
    let lobes = [
        LobeModel::new(Lobe::Geometric, 0.3, Curve::Sqrt),
        LobeModel::new(Lobe::Ggx, 0.4, Curve::Smooth),
    ];
    let columns = [
        (ViewKind::Polar, "lobe,view_angle_deg,angle_deg,value"),
        (ViewKind::Solid, "lobe,view_angle_deg,x,y,z,value"),
        (ViewKind::Hemisphere, "lobe,view_angle_deg,x,y,z,density"),
        (ViewKind::Albedo, "lobe,view_angle_deg,albedo,compensated"),
        (ViewKind::Reciprocity, "lobe,view_angle_deg,rms,max"),
        (ViewKind::Horizon, "lobe,view_angle_deg,fraction_below"),
        (ViewKind::Distance, "lobe,distance,density"),
    ];
    assert_eq!(columns.map(|(kind, _)| kind), ViewKind::ALL);
    let folder = Workplace::new();
    for (kind, header) in columns {
        let view = lobe_view(kind, &lobes, &[20.0, 60.0]);
        let csv = view.csv();
        let mut rows = csv.lines();
        assert_eq!(rows.next(), Some(header));
        let count = header.split(',').count();
        for row in rows {
            // The first field is quoted and has a comma.
            let numbers = row.rsplit_once("\",").unwrap().1;
            assert_eq!(
                numbers.split(',').filter(|x| x.parse::<f64>().is_ok()).count(),
                count - 1,
                "{row}"
            );
        }
        let [png, svg] = ["png", "svg"].map(|ending| folder.path(format!("{}.{ending}", kind.name())));
        for path in [&png, &svg] {
            std::fs::write(path, plot_file(path, &view).unwrap()).unwrap();
        }
        let picture = image::open(&png).unwrap().to_rgb8();
        let spread = |pixel: &image::Rgb<u8>| {
            let [r, g, b] = pixel.0;
            r.max(g).max(b) - r.min(g).min(b)
        };
        let colored = picture.pixels().filter(|pixel| spread(pixel) > 40);
        assert!(colored.count() > 200, "{}", kind.name());
        assert_eq!(
            std::fs::read_to_string(&svg).unwrap().contains("GGX 0.4"),
            kind.shows(Lobe::Ggx),
            "{}",
            kind.name()
        );
    }
}
