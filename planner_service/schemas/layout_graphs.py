"""Graphs of furniture over HTTP: the pieces that scripts use and which of them belong together."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from planner_service.schemas.stories import Ask
from scene_graphs.distance import MAX_NODES

Affordance = Literal["sit", "lie", "touch"]
MAX_GRAPHS = 12
"""As many as a story has short scripts."""
MAX_EDGES = 200
Place = Annotated[int, Field(ge=0, lt=MAX_NODES)]
Edge = Annotated[list[Place], Field(min_length=2, max_length=2)]


class NodeAsk(Ask):
    """A piece of furniture that a script uses."""

    category: str = Field(min_length=1, max_length=60, description='A furniture word, such as "sofa".')
    instance: int = Field(1, ge=1, le=99, description="Tells two pieces of a kind apart.")
    needs: list[Affordance] = Field([], max_length=3, description="What a body must be able to do there.")


class GraphAsk(Ask):
    """Furniture, and which pieces belong together."""

    nodes: list[NodeAsk] = Field(min_length=1, max_length=MAX_NODES)
    edges: list[Edge] = Field([], max_length=MAX_EDGES, description="Pairs of places in `nodes`.")


class MergeAsk(Ask):
    """One graph a script."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "graphs": [
                        {
                            "nodes": [{"category": "sofa", "needs": ["sit"]}, {"category": "coffee table"}],
                            "edges": [[0, 1]],
                        },
                        {
                            "nodes": [{"category": "couch"}, {"category": "sofa", "instance": 2}, {"category": "lamp"}],
                            "edges": [[1, 2]],
                        },
                    ]
                }
            ]
        }
    )

    graphs: list[GraphAsk] = Field(min_length=1, max_length=MAX_GRAPHS)
    method: Literal["canonical", "aligned"] = Field(
        "canonical", description="Pieces numbered in their order, as in the paper; or so that most edges are shared."
    )


class GraphNode(BaseModel):
    """A piece of furniture."""

    category: str
    instance: int


class MergedNode(GraphNode):
    """A piece of furniture that one or several scripts use."""

    needs: list[Affordance] = Field(description="All that any of the scripts does there.")
    minor: bool = Field(description="Whether it is a less important node (SIMS 3.2).")


class MergedGraph(BaseModel):
    """The furniture of all scripts: of every category as many pieces as the script has that uses most."""

    nodes: list[MergedNode]
    edges: list[tuple[int, int]] = Field(description="Pairs of places in `nodes`, the smaller first.")


class Merged(BaseModel):
    """One graph for many scripts, and where every script's own pieces went in it."""

    graph: MergedGraph
    instance_maps: list[list[int]] = Field(
        description="For each graph that was sent, and each of its nodes, the place in `graph.nodes`."
    )
