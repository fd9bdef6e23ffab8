//! A run as a picture: force, length, velocity and, where given, inputs over time, in SVG.

use plotters::coord::Shift;
use plotters::prelude::*;

/// A quantity over time.
#[derive(Clone, Debug)]
pub struct Series {
    /// Axis label with unit.
    pub label: &'static str,
    /// Time (s) and value.
    pub points: Vec<(f64, f64)>,
}

/// Size of a panel, pixels.
const PANEL: (u32, u32) = (900, 210);

/// Draws one panel per series, one below the other, over the same time.
pub fn draw(title: &str, series: &[Series]) -> Result<String, String> {
    let mut svg = String::new();
    {
        let size = (PANEL.0, PANEL.1 * series.len() as u32 + 40);
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE).map_err(|e| e.to_string())?;
        let root = root.titled(title, ("sans-serif", 20)).map_err(|e| e.to_string())?;
        for (area, one) in root.split_evenly((series.len(), 1)).iter().zip(series) {
            panel(area, one).map_err(|e| e.to_string())?;
        }
        root.present().map_err(|e| e.to_string())?;
    }
    Ok(svg)
}

fn panel(
    area: &DrawingArea<SVGBackend<'_>, Shift>,
    series: &Series,
) -> Result<(), Box<dyn std::error::Error>> {
    let bounds = |values: &mut dyn Iterator<Item = f64>| {
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| {
            (least.min(value), most.max(value))
        })
    };
    let (start, end) = bounds(&mut series.points.iter().map(|point| point.0));
    let (least, most) = bounds(&mut series.points.iter().map(|point| point.1));
    // A constant still needs some height to be drawn in.
    let margin = (0.05 * (most - least)).max(1e-6 * most.abs()).max(1e-9);
    let mut chart = ChartBuilder::on(area)
        .margin(8)
        .x_label_area_size(34)
        .y_label_area_size(80)
        .build_cartesian_2d(start..end, (least - margin)..(most + margin))?;
    chart
        .configure_mesh()
        .x_desc("time (s)")
        .y_desc(series.label)
        .axis_desc_style(("sans-serif", 14))
        .label_style(("sans-serif", 13))
        .x_labels(10)
        .y_labels(5)
        .light_line_style(WHITE)
        .draw()?;
    chart.draw_series(LineSeries::new(series.points.iter().copied(), &BLUE))?;
    Ok(())
}
