//! Queries about a square, answered on a card.

use crate::formats::{ANSWER_WORDS, Frame, POINT_WORDS, Query, THREADS, Target, source};
use crate::pace::Pace;
use crate::uploaded_scene::UploadedScene;
use graphics_card::{Bound, Commands, Gpu, Lost, Pass, bind_group_layout, shader_module};
use scene::Scene;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;
use trace::{FlatSpace, PointSet, PreparedSight, SightQuery, Square, TargetPoints, Tracer, Viewpoint};
use wgpu::{BindGroup, BindGroupLayout, Buffer, BufferUsages, Device};

/// The pass that answers queries, compiled once a card.
struct VisibilityPass {
    pass: Pass,
    layout: BindGroupLayout,
}

impl VisibilityPass {
    fn new(device: &Device) -> Self {
        let reads = (0..4).map(|binding| (binding, Bound::Read));
        let layout = bind_group_layout(device, reads.chain([(4, Bound::Write), (5, Bound::Uniform)]));
        let pass = Pass::new(&shader_module(device, "sight", source()), &layout, "answer", &[]);
        Self { pass, layout }
    }
}

/// A card that is ready for queries about a square.
pub struct Prepared {
    gpu: Gpu,
    pass: Arc<VisibilityPass>,
    scene: Arc<UploadedScene>,
    /// The scene whose points are looked from, and the space that the card knows them in.
    surface: Arc<Scene>,
    space: FlatSpace,
    targets: Buffer,
    frame: Frame,
    batch: Mutex<BatchRoom>,
}

/// Room for one batch at a time.
struct BatchRoom {
    pace: Pace,
    frame: Buffer,
    /// Queries, answers and what binds them, for as many as there is room for.
    buffers: Option<(usize, Buffer, Buffer, BindGroup)>,
}

impl Prepared {
    /// Uploads the targets of a square.
    ///
    /// # Errors
    /// The card is lost, or has no room.
    pub fn new(
        gpu: &Gpu,
        scene: Arc<UploadedScene>,
        tracer: &Tracer,
        square: &Square,
        targets: &[&TargetPoints],
    ) -> Result<Self, Lost> {
        let space = tracer.flat().space();
        let targets: Vec<Target> = targets.iter().map(|target| Target::from(*target)).collect();
        let words: &[u32] = bytemuck::cast_slice(&targets);
        let room = gpu.buffer("targets", words.len(), BufferUsages::STORAGE | BufferUsages::COPY_DST)?;
        gpu.write(&room, words);
        let center = space.position(square.center);
        let [right, up] = [square.right, square.up].map(|side| space.direction(side));
        let axis = right.cross(up).normalize_or_zero();
        let frame = Frame {
            center_high: center.high.to_array(),
            count: 0,
            center_low: center.low.to_array(),
            node_count: scene.node_count,
            right: right.as_vec3().to_array(),
            padding_right: 0,
            up: up.as_vec3().to_array(),
            padding_up: 0,
            axis: axis.as_vec3().to_array(),
            padding_axis: 0,
        };
        let batch = BatchRoom {
            pace: Pace::new(),
            frame: gpu.struct_buffer::<Frame>("frame", BufferUsages::UNIFORM)?,
            buffers: None,
        };
        let surface = tracer.scene().clone();
        let pass = gpu.cached(VisibilityPass::new);
        gpu.check()?;
        let batch = Mutex::new(batch);
        Ok(Self { gpu: gpu.clone(), pass, scene, surface, space, targets: room, frame, batch })
    }

    /// The answers' words, in the order of the queries.
    fn answers(&self, queries: &[Query]) -> Result<Vec<u32>, Lost> {
        let mut batch = self.batch.lock().unwrap_or_else(PoisonError::into_inner);
        let mut answers = Vec::with_capacity(queries.len() * ANSWER_WORDS);
        let mut left = queries;
        while !left.is_empty() {
            let (now, later) = left.split_at(batch.pace.size().min(left.len()));
            let begun = Instant::now();
            answers.extend(self.answers_of_batch(&mut batch, now)?);
            batch.pace.learn(now.len(), begun.elapsed());
            left = later;
        }
        Ok(answers)
    }

    fn answers_of_batch(&self, batch: &mut BatchRoom, queries: &[Query]) -> Result<Vec<u32>, Lost> {
        self.gpu.check()?;
        let count = queries.len();
        if batch.buffers.as_ref().is_none_or(|(room, ..)| *room < count) {
            batch.buffers = Some(self.room(count, &batch.frame)?);
        }
        let Some((_, room_for_queries, room_for_answers, bound)) = &batch.buffers else { return Err(Lost) };
        self.gpu.write(room_for_queries, bytemuck::cast_slice(queries));
        self.gpu.write_struct(&batch.frame, &Frame { count: count as u32, ..self.frame });
        let mut work = Commands::new(&self.gpu);
        work.dispatch(&self.pass.pass, bound, [(count as u32).div_ceil(THREADS), 1]);
        work.submit();
        self.gpu.read(room_for_answers, 0..4 * (count * ANSWER_WORDS) as u64)
    }

    /// Buffers for `count` queries.
    fn room(&self, count: usize, frame: &Buffer) -> Result<(usize, Buffer, Buffer, BindGroup), Lost> {
        let words = count * size_of::<Query>() / 4;
        let queries = self.gpu.buffer("queries", words, BufferUsages::STORAGE | BufferUsages::COPY_DST)?;
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        let answers = self.gpu.buffer("answers", count * ANSWER_WORDS, usage)?;
        let buffers = [&self.scene.nodes, &self.scene.triangles, &self.targets, &queries, &answers, frame];
        let bound = self.gpu.bind(&self.pass.layout, (0..).zip(buffers));
        Ok((count, queries, answers, bound))
    }

    fn query(&self, SightQuery { from, target }: &SightQuery) -> Query {
        match from {
            Viewpoint::Surface(point) => {
                let eye = self.space.position(point.position(&self.surface));
                Query::at(eye, point.triangle, *target)
            }
            Viewpoint::Infinity(direction) => Query::toward(direction.normalize_or_zero().as_vec3(), *target),
        }
    }
}

impl PreparedSight for Prepared {
    fn hidden(&self, queries: &[SightQuery]) -> Option<Vec<Option<PointSet>>> {
        let queries: Vec<Query> = queries.iter().map(|query| self.query(query)).collect();
        let words = self.answers(&queries).ok()?;
        let answer = |words: &[u32; ANSWER_WORDS]| {
            let hidden: [u32; POINT_WORDS] = std::array::from_fn(|word| words[word]);
            (words[POINT_WORDS] == 1).then(|| PointSet::from(hidden))
        };
        Some(words.as_chunks().0.iter().map(answer).collect())
    }
}
