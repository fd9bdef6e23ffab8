//! Lines over a common axis, with units, ticks and a legend, as SVG.
//!
//! Coordinates are in tenths of a pixel: rounded to pixels, a gentle slope would be a staircase.

use std::fmt::Write;

/// A point: along the horizontal axis, and the vertical one.
pub type Point = (f64, f64);

/// A line, or points that are marked.
#[derive(Clone, Debug)]
pub struct Line {
    /// Label; lines without one are not in the legend.
    pub label: String,
    /// Its points.
    pub points: Vec<Point>,
    /// Draws circles in the colour of the line at the same index, instead of a line.
    pub marks: bool,
}

impl Line {
    /// A line.
    pub fn new(label: impl Into<String>, points: impl IntoIterator<Item = Point>) -> Self {
        Self { label: label.into(), points: points.into_iter().collect(), marks: false }
    }

    /// Published points, compared with a line.
    pub fn marks(label: impl Into<String>, points: impl IntoIterator<Item = Point>) -> Self {
        Self { marks: true, ..Self::new(label, points) }
    }
}

/// One panel of a chart.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Label of the vertical axis, with its unit.
    pub y: &'static str,
    /// Lines; a single one needs no legend.
    pub lines: Vec<Line>,
    /// An input: half as high.
    pub input: bool,
}

impl Panel {
    /// A panel of results.
    pub fn new(y: &'static str, lines: Vec<Line>) -> Self {
        Self { y, lines, input: false }
    }

    /// A panel of inputs.
    pub fn input(y: &'static str, lines: Vec<Line>) -> Self {
        Self { y, lines, input: true }
    }
}

/// A chart: panels below each other over the same axis.
#[derive(Clone, Debug)]
pub struct Chart<'a> {
    /// Title.
    pub title: &'a str,
    /// Label of the horizontal axis, with its unit.
    pub x: &'static str,
    /// At least one.
    pub panels: Vec<Panel>,
}

/// Width of a chart: narrow for phones, but wide enough for two seconds at 10 Hz.
const WIDTH: f64 = 720.0;
/// Left and right of the panels: labels of the vertical axis, and half of the last one of the
/// horizontal axis.
const LEFT: f64 = 82.0;
const RIGHT: f64 = 30.0;
/// Heights: of the title, of a panel, of an input's panel, between panels, of a row of the legend,
/// below the last panel.
const TITLE: f64 = 34.0;
const PANEL: f64 = 200.0;
const INPUT: f64 = 105.0;
const GAP: f64 = 16.0;
const LEGEND_ROW: f64 = 20.0;
const X_AXIS: f64 = 50.0;
/// Approximate width of a letter of the legend, and width of a sample.
const LETTER: f64 = 7.0;
const SAMPLE: f64 = 36.0;
/// Columns of at least a pixel to which a line is thinned.
const COLUMNS: usize = 600;
/// Colour-blind safe palette (Okabe and Ito), darkest first.
const COLOURS: [&str; 6] = ["#000000", "#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00"];
/// Dashes of coinciding lines, through whose gaps the line below is visible.
const DASHES: [&str; 6] = ["none", "8 5", "3 4", "12 4 3 4", "5 3", "2 5"];

impl Chart<'_> {
    /// The chart as SVG.
    pub fn draw(&self) -> String {
        let horizontal = Axis::exact(self.points().map(|point| point.0), LEFT, WIDTH - RIGHT);
        let mut body = text(WIDTH / 2.0, 23.0, 18, "middle", "title", self.title);
        let mut top = TITLE;
        for (index, panel) in self.panels.iter().enumerate() {
            top = legend(&mut body, panel, top);
            let bottom = top + if panel.input { INPUT } else { PANEL };
            let last = index + 1 == self.panels.len();
            draw_panel(&mut body, panel, &horizontal, top, bottom, last);
            top = bottom + GAP;
        }
        let height = top - GAP + X_AXIS;
        body.push_str(&text(WIDTH - RIGHT, height - 10.0, 14, "end", "axis", self.x));
        format!(
            "<svg width=\"{WIDTH}\" height=\"{height}\" viewBox=\"0 0 {WIDTH} {height}\" \
             xmlns=\"http://www.w3.org/2000/svg\" font-family=\"sans-serif\">\n\
             <rect width=\"{WIDTH}\" height=\"{height}\" fill=\"white\"/>\n{body}</svg>\n"
        )
    }

    fn points(&self) -> impl Iterator<Item = Point> {
        let lines = self.panels.iter().flat_map(|panel| &panel.lines);
        lines.flat_map(|line| line.points.iter().copied())
    }
}

/// An axis: its range, and its pixels.
struct Axis {
    least: f64,
    most: f64,
    start: f64,
    end: f64,
}

impl Axis {
    /// An axis over the range of some values.
    fn exact(values: impl Iterator<Item = f64>, start: f64, end: f64) -> Self {
        let finite = values.filter(|value| value.is_finite());
        let (least, most) =
            finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        if least > most {
            return Self { least: 0.0, most: 1.0, start, end };
        }
        // Values that differ by rounding only count as constant: their axis spans a tenth of the
        // value on both sides, or one unit around 0, for short labels.
        if most - least <= 1e-6 * most.abs() {
            let around = if most == 0.0 { 1.0 } else { 0.1 * most.abs() };
            return Self { least: least - around, most: most + around, start, end };
        }
        Self { least, most, start, end }
    }

    /// The same with a margin of 5 % at both ends.
    fn padded(values: impl Iterator<Item = f64>, start: f64, end: f64) -> Self {
        let Self { least, most, .. } = Self::exact(values, start, end);
        let free = 0.05 * (most - least);
        Self { least: least - free, most: most + free, start, end }
    }

    fn place(&self, value: f64) -> f64 {
        self.start + (value - self.least) / (self.most - self.least) * (self.end - self.start)
    }

    /// About `count` round values, and the decimals they need.
    fn ticks(&self, count: f64) -> (Vec<f64>, usize) {
        let raw = (self.most - self.least) / count;
        let power = 10_f64.powf(raw.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|part| part * power);
        let step = step.into_iter().find(|step| *step >= raw * 0.999).unwrap_or(raw);
        let digits = (-(step.log10() + 1e-9).floor()).max(0.0) as usize;
        // Values beyond an end by rounding only count as at that end.
        let first = (self.least / step - 1e-6).ceil() as i64;
        let last = (self.most / step + 1e-6).floor() as i64;
        ((first..=last).map(|index| index as f64 * step).collect(), digits)
    }
}

fn draw_panel(
    body: &mut String,
    panel: &Panel,
    horizontal: &Axis,
    top: f64,
    bottom: f64,
    last: bool,
) {
    let values = panel.lines.iter().flat_map(|line| &line.points).map(|point| point.1);
    let vertical = Axis::padded(values, bottom, top);
    let (ticks, digits) = vertical.ticks(if panel.input { 3.0 } else { 6.0 });
    for tick in ticks {
        let y = vertical.place(tick);
        rule(body, "grid", (LEFT, y), (WIDTH - RIGHT, y));
        body.push_str(&text(LEFT - 6.0, y + 4.0, 13, "end", "tick-y", &format!("{tick:.digits$}")));
    }
    let (ticks, digits) = horizontal.ticks(8.0);
    for tick in ticks {
        let x = horizontal.place(tick);
        rule(body, "grid", (x, top), (x, bottom));
        if last {
            let label = format!("{tick:.digits$}");
            body.push_str(&text(x, bottom + 17.0, 13, "middle", "tick-x", &label));
        }
    }
    let (width, height) = (WIDTH - RIGHT - LEFT, bottom - top);
    let _string = writeln!(
        body,
        "<rect class=\"frame\" x=\"{LEFT}\" y=\"{top}\" width=\"{width}\" \
         height=\"{height}\" fill=\"none\" \
         stroke=\"#555\"/>"
    );
    let middle = (top + bottom) / 2.0;
    let _string = writeln!(
        body,
        "<text class=\"axis\" transform=\"translate(18 {middle}) rotate(-90)\" font-size=\"{}\" \
         text-anchor=\"middle\">{}</text>",
        if panel.input { 12 } else { 14 },
        escaped(panel.y)
    );
    for (line, style) in styled(panel) {
        if line.marks {
            for &(x, y) in line.points.iter().filter(|point| point.1.is_finite()) {
                let (x, y) = (horizontal.place(x), vertical.place(y));
                mark(body, style, x, y);
            }
        } else {
            let place = |(x, y): Point| (horizontal.place(x), vertical.place(y));
            polyline(body, style, thinned(&line.points).into_iter().map(place));
        }
    }
}

/// The lines of a panel with the index of their colour; marks have the colour of their line.
fn styled(panel: &Panel) -> impl Iterator<Item = (&Line, usize)> {
    let mut next = [0, 0];
    panel.lines.iter().map(move |line| {
        let counter = &mut next[usize::from(line.marks)];
        *counter += 1;
        (line, (*counter - 1) % COLOURS.len())
    })
}

/// A line, with gaps at values that are not finite.
fn polyline(body: &mut String, style: usize, points: impl Iterator<Item = Point>) {
    let mut text = String::new();
    let (colour, dash) = (COLOURS[style], DASHES[style]);
    let mut end = |text: &mut String| {
        if !text.is_empty() {
            let _string = writeln!(
                body,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{}\" \
                 stroke-dasharray=\"{dash}\" stroke-linejoin=\"round\"/>",
                text.trim_end(),
                if style == 0 { 2.4 } else { 1.8 },
            );
            text.clear();
        }
    };
    for (x, y) in points {
        if y.is_finite() {
            let _string = write!(text, "{x:.1},{y:.1} ");
        } else {
            end(&mut text);
        }
    }
    end(&mut text);
}

fn mark(body: &mut String, style: usize, x: f64, y: f64) {
    let colour = COLOURS[style];
    let _string = writeln!(
        body,
        "<circle class=\"mark\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"white\" \
         stroke=\"{colour}\" \
         stroke-width=\"1.5\"/>"
    );
}

fn rule(body: &mut String, class: &str, from: Point, to: Point) {
    let _string = writeln!(
        body,
        "<line class=\"{class}\" x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" \
         stroke=\"#ddd\"/>",
        from.0, from.1, to.0, to.1
    );
}

/// The legend above a panel, outside the data. Returns the top of the panel.
fn legend(body: &mut String, panel: &Panel, top: f64) -> f64 {
    if panel.lines.len() < 2 {
        return top;
    }
    let (mut x, mut y) = (LEFT, top + 0.5 * LEGEND_ROW);
    for (line, style) in styled(panel).filter(|(line, _)| !line.label.is_empty()) {
        let width = SAMPLE + LETTER * line.label.chars().count() as f64 + 12.0;
        if x + width > WIDTH - 4.0 && x > LEFT {
            (x, y) = (LEFT, y + LEGEND_ROW);
        }
        if line.marks {
            mark(body, style, x + 14.0, y);
        } else {
            polyline(body, style, [(x, y), (x + 28.0, y)].into_iter());
        }
        body.push_str(&text(x + SAMPLE, y + 4.0, 13, "start", "legend", &line.label));
        x += width;
    }
    y + 0.5 * LEGEND_ROW + 2.0
}

fn text(x: f64, y: f64, size: u32, anchor: &str, class: &str, text: &str) -> String {
    format!(
        "<text class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" \
         text-anchor=\"{anchor}\">{}</text>\n",
        escaped(text)
    )
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// A thinned line: the least and greatest point of each column, in order.
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

    /// As the path of an isometric scenario: labels 16.00000 and 16.00001 would be useless.
    #[test]
    fn the_axis_of_a_constant_has_short_labels() {
        for (value, count) in [(16.0, 3.0), (16.000_000_1, 6.0), (0.0, 3.0), (-0.25, 3.0)] {
            let axis = Axis::padded([value, value].into_iter(), 100.0, 0.0);
            let (ticks, digits) = axis.ticks(count);
            assert!(digits <= 2, "{value}: {digits} digits");
            assert!(!ticks.is_empty(), "{value}: no label");
            assert!((axis.place(value) - 50.0).abs() < 1e-3, "{value}");
        }
    }

    #[test]
    fn ticks_are_round_and_reach_both_ends() {
        let axis = |least, most| Axis { least, most, start: 0.0, end: 1.0 };
        assert_eq!(
            axis(0.0, 1.0).ticks(5.0),
            (vec![0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0], 1)
        );
        assert_eq!(axis(-3.0, 48.0).ticks(5.0).0, [0.0, 20.0, 40.0]);
        assert_eq!(axis(0.0, 0.3).ticks(8.0).0.last(), Some(&0.30000000000000004));
        let (ticks, digits) = axis(1e-5, 9e-5).ticks(5.0);
        assert_eq!((ticks.len(), digits), (4, 5));
    }

    #[test]
    fn labels_are_escaped_and_non_finite_values_are_gaps() {
        let points = [(0.0, 1.0), (1.0, f64::NAN), (2.0, 3.0)];
        let panels = vec![Panel::new(
            "force (N)",
            vec![Line::new("a < b & c", points), Line::new("d", points)],
        )];
        let svg = Chart { title: "<title>", x: "time (s)", panels }.draw();
        assert!(svg.contains("a &lt; b &amp; c") && svg.contains("&lt;title&gt;"), "{svg}");
        assert!(!svg.contains("NaN"), "{svg}");
    }
}
