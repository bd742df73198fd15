"""A body and what moves it. May import `scene_graphs`, never the planner."""
