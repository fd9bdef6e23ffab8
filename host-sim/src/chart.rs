//! Lines over a common axis, with units and a legend, as SVG.

use plotters::coord::Shift;
use plotters::prelude::*;

/// A point: along the horizontal axis, and the vertical one.
pub type Point = (f64, f64);

/// A line: what it is, and its points.
pub type Line = (String, Vec<Point>);

/// One panel of a chart.
#[derive(Clone, Debug)]
pub struct Panel {
    /// What is along the vertical axis, with its unit.
    pub y: &'static str,
    /// What is in it; a single line needs no legend.
    pub lines: Vec<Line>,
}

/// A chart: panels below each other over the same axis.
#[derive(Clone, Debug)]
pub struct Chart<'a> {
    /// Above all.
    pub title: &'a str,
    /// What is along the horizontal axis, with its unit.
    pub x: &'static str,
    /// At least one.
    pub panels: Vec<Panel>,
}

/// Size of a panel, pixels: as narrow as lines of two seconds at 10 Hz can be told apart in, for phones.
const PANEL: (u32, u32) = (720, 260);
const TITLE_HEIGHT: u32 = 40;
/// Room for the legend, as a share of the lines' height.
const LEGEND: f64 = 0.35;
/// Columns, of at least a pixel, that a line is thinned to: more of it cannot be seen.
const COLUMNS: usize = 600;
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
    /// The chart as SVG.
    pub fn draw(&self) -> Result<String, String> {
        let mut svg = String::new();
        self.draw_into(&mut svg).map_err(|error| error.to_string())?;
        Ok(svg)
    }

    fn draw_into(&self, svg: &mut String) -> Result<(), Box<dyn std::error::Error>> {
        let size = (PANEL.0, PANEL.1 * self.panels.len() as u32 + TITLE_HEIGHT);
        let root = SVGBackend::with_string(svg, size).into_drawing_area();
        root.fill(&WHITE)?;
        let root = root.titled(self.title, ("sans-serif", 18))?;
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
        let legend = panel.lines.len() > 1;
        let points = || panel.lines.iter().flat_map(|(_, points)| points);
        let range = |values: &mut dyn Iterator<Item = f64>, below: f64, above: f64| {
            let (least, most) =
                values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
            // A constant still needs some height to be drawn in.
            let height = (most - least).max(1e-6 * most.abs()).max(1e-9);
            (least - below * height)..(most + above * height)
        };
        // Above the lines there is room for the legend.
        let (x, y) = (
            range(&mut points().map(|point| point.0), 0.0, 0.0),
            range(&mut points().map(|point| point.1), 0.05, if legend { LEGEND } else { 0.05 }),
        );
        let mut chart = ChartBuilder::on(area)
            .margin(8)
            .x_label_area_size(40)
            .y_label_area_size(80)
            .build_cartesian_2d(x, y)?;
        chart
            .configure_mesh()
            .x_desc(self.x)
            .y_desc(panel.y)
            .axis_desc_style(("sans-serif", 14))
            .label_style(("sans-serif", 13))
            .x_labels(8)
            .y_labels(6)
            .light_line_style(WHITE)
            .draw()?;
        for ((label, points), colour) in panel.lines.iter().zip(COLOURS.iter().cycle()) {
            let drawn =
                chart.draw_series(LineSeries::new(thinned(points), colour.stroke_width(2)))?;
            if legend {
                drawn.label(label).legend(move |(x, y)| {
                    PathElement::new([(x, y), (x + 20, y)], colour.stroke_width(2))
                });
            }
        }
        if legend {
            chart
                .configure_series_labels()
                .position(SeriesLabelPosition::UpperLeft)
                .label_font(("sans-serif", 13))
                .background_style(WHITE.mix(0.8))
                .border_style(BLACK.mix(0.4))
                .draw()?;
        }
        Ok(())
    }
}

/// A line with no more points than can be seen: of each column the least and the greatest, in their order.
fn thinned(points: &[Point]) -> Vec<Point> {
    if points.len() <= 2 * COLUMNS {
        return points.to_vec();
    }
    let of_column = |column: &[Point]| {
        let by_height = |a: &&Point, b: &&Point| a.1.total_cmp(&b.1);
        let least = column.iter().min_by(by_height).copied();
        let most = column.iter().max_by(by_height).copied();
        let mut both: Vec<Point> = least.into_iter().chain(most).collect();
        both.sort_by(|a, b| a.0.total_cmp(&b.0));
        both
    };
    points.chunks(points.len().div_ceil(COLUMNS)).flat_map(of_column).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thinned_line_keeps_its_peaks() {
        let mut points: Vec<Point> =
            (0..10_000).map(|i| (f64::from(i), f64::from(i % 7) * 1e-3)).collect();
        points[4321].1 = 5.0;
        points[7654].1 = -3.0;
        let thin = thinned(&points);
        assert!(thin.len() <= 2 * COLUMNS + 2, "{} points", thin.len());
        assert!(thin.contains(&(4321.0, 5.0)) && thin.contains(&(7654.0, -3.0)));
        assert!(thin.windows(2).all(|pair| pair[0].0 <= pair[1].0));
        assert_eq!(thinned(&points[..100]), points[..100]);
    }
}
