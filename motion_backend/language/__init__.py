"""What words mean: sentence features for captions and summaries."""
