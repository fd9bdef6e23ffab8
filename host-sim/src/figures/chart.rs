//! Lines over a common axis, with units and a legend, as SVG.

use plotters::coord::Shift;
use plotters::prelude::*;

/// A line: what it is, and its points.
pub(super) type Line = (String, Vec<(f64, f64)>);

/// One panel of a figure.
pub(super) struct Panel {
    /// What is along the vertical axis, with its unit.
    pub(super) y: &'static str,
    pub(super) lines: Vec<Line>,
}

/// A figure: panels below each other over the same axis.
pub(super) struct Chart<'a> {
    pub(super) title: &'a str,
    /// What is along the horizontal axis, with its unit.
    pub(super) x: &'static str,
    pub(super) panels: Vec<Panel>,
}

/// Size of a panel, pixels.
const PANEL: (u32, u32) = (900, 320);
const TITLE_HEIGHT: u32 = 40;
/// Room for the legend, as a share of the lines' height.
const LEGEND: f64 = 0.35;
/// Colours that stay apart for most eyes (Okabe and Ito), darkest first.
const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 0, 0),
    RGBColor(213, 94, 0),
    RGBColor(0, 114, 178),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
];

impl Chart<'_> {
    /// The figure as SVG.
    pub(super) fn draw(&self) -> Result<String, String> {
        let mut svg = String::new();
        self.draw_into(&mut svg).map_err(|error| error.to_string())?;
        Ok(svg)
    }

    fn draw_into(&self, svg: &mut String) -> Result<(), Box<dyn std::error::Error>> {
        let size = (PANEL.0, PANEL.1 * self.panels.len() as u32 + TITLE_HEIGHT);
        let root = SVGBackend::with_string(svg, size).into_drawing_area();
        root.fill(&WHITE)?;
        let root = root.titled(self.title, ("sans-serif", 20))?;
        for (area, panel) in root.split_evenly((self.panels.len(), 1)).iter().zip(&self.panels) {
            self.draw_panel(area, panel)?;
        }
        root.present()?;
        Ok(())
    }

    fn draw_panel(
        &self,
        area: &DrawingArea<SVGBackend<'_>, Shift>,
        panel: &Panel,
    ) -> Result<(), Box<dyn std::error::Error>> {
        let points = || panel.lines.iter().flat_map(|(_, points)| points);
        let range = |values: &mut dyn Iterator<Item = f64>, below: f64, above: f64| {
            let (least, most) =
                values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
            let height = (most - least).max(1e-9);
            (least - below * height)..(most + above * height)
        };
        // Above the lines there is room for the legend.
        let (x, y) = (
            range(&mut points().map(|point| point.0), 0.0, 0.0),
            range(&mut points().map(|point| point.1), 0.05, LEGEND),
        );
        let mut chart = ChartBuilder::on(area)
            .margin(8)
            .x_label_area_size(40)
            .y_label_area_size(70)
            .build_cartesian_2d(x, y)?;
        chart
            .configure_mesh()
            .x_desc(self.x)
            .y_desc(panel.y)
            .axis_desc_style(("sans-serif", 14))
            .label_style(("sans-serif", 13))
            .light_line_style(WHITE)
            .draw()?;
        for ((label, points), colour) in panel.lines.iter().zip(COLOURS.iter().cycle()) {
            chart
                .draw_series(LineSeries::new(points.iter().copied(), colour.stroke_width(2)))?
                .label(label)
                .legend(move |(x, y)| {
                    PathElement::new([(x, y), (x + 20, y)], colour.stroke_width(2))
                });
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperLeft)
            .label_font(("sans-serif", 13))
            .background_style(WHITE.mix(0.8))
            .border_style(BLACK.mix(0.4))
            .draw()?;
        Ok(())
    }
}
