"""What a body is made of: contact capsules, ranges of joints, collisions, and the person we draw."""
