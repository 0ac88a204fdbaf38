"""From observations to repaired, verified and recorded episodes."""
