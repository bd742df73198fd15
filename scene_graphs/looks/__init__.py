"""What furniture and rooms look like: shapes, materials, and how they dress the solid parts of `scene_graphs.forms`."""
