"""World models whose predictions are grounded into facts: encoders, checkpoints, networks (extra ``learn``)."""
