//! The command where logs of robots are built in.

use std::fmt::Write;
use std::path::PathBuf;
use std::time::Duration;

use anyhow::anyhow;
use aquafuse::depth::DepthKind;
use aquafuse_data::bag::{self, DepthTopic, Request, Summary};
use aquafuse_data::files::display;
use aquafuse_data::pipeline::{Operation, PixelEncoding};
use aquafuse_data::video::Recipe;

use super::Bag;
use crate::args::common::Common;
use crate::args::water::WaterSource;
use crate::failure::Failure;
use crate::report::output;
use crate::report::progress::Progress;

impl Bag {
    pub(crate) fn run(&self, common: &Common) -> Result<(), Failure> {
        let common = &self.settings.cutting(&self.border, common);
        let water = self.water.as_deref().map(WaterSource::parse).transpose()?;
        let recipe = self.recipe(water.as_ref(), common)?;
        let mut request = Request::new(&self.input, &self.output);
        request.inputs = water.as_ref().and_then(WaterSource::path).map(PathBuf::from).into_iter().collect();
        request.topics.clone_from(&self.topics);
        request.depth = self
            .depth_topic
            .clone()
            .map(|name| DepthTopic { name, within: Duration::from_millis(self.depth_within.into()) });
        request.overwrite = self.overwrite;
        let progress = Progress::new(common.quiet);
        let ended = bag::change(&request, &recipe, &common.run_options(), &mut || progress.done(""));
        progress.finish();
        let summary = ended.map_err(Failure::work)?;
        if !common.quiet {
            output::print(&self.text(&summary))?;
        }
        self.outcome(&summary)
    }

    fn recipe(&self, water: Option<&WaterSource>, common: &Common) -> Result<Recipe, Failure> {
        let mut settings = self.settings.get()?;
        let depth_model = std::mem::take(&mut settings.depth_model);
        let operation = match water {
            None if self.restore => Operation::Restore {
                options: self.max_gain.options(),
                levels: self.levels.options(),
                encoding: PixelEncoding::Encoded,
            },
            None => Operation::Enhance { levels: self.levels.options() },
            Some(water) => {
                self.waters.refuse_unread(settings.options.model)?;
                let file = self.waters.read(water, &depth_model, PixelEncoding::Encoded, &common.reading)?;
                let unit = if self.depth_topic.is_some() { DepthKind::Metres } else { depth_model.kind() };
                let reference = self.waters.per(unit, &file)?;
                Operation::Fuse { reference, options: settings.options }
            }
        };
        Ok(Recipe {
            depth_model,
            smoothing: settings.smoothing,
            border: common.reading.border,
            water_map: common.reading.water_map,
            steady_over: self.steady_over.into(),
            ..Recipe::new(operation)
        })
    }

    fn text(&self, summary: &Summary) -> String {
        let mut text = format!("{}: {} messages\n", display(&self.output), summary.messages);
        for topic in &summary.topics {
            let _ = write!(text, "  {}  {} changed", topic.name, topic.changed);
            if let Some(reason) = &topic.kept_for {
                let _ = write!(text, ", {} kept as they are: {reason}", topic.kept);
            }
            text.push('\n');
        }
        text
    }

    fn outcome(&self, summary: &Summary) -> Result<(), Failure> {
        if let Some(cause) = &summary.cut {
            return Err(Failure::work(anyhow!(
                "{} is cut short: {cause}. Its {} whole messages are in {}",
                display(&self.input),
                summary.messages,
                display(&self.output)
            )));
        }
        let Some((topic, fault)) =
            summary.topics.iter().find_map(|topic| Some((topic, topic.fault.as_ref()?)))
        else {
            return Ok(());
        };
        Err(Failure::work(anyhow!(
            "{} messages of {} in {} are damaged and were copied as they are; the first: {fault}",
            topic.damaged,
            topic.name,
            display(&self.input)
        )))
    }
}
