"""Skills: closed-loop motions of the arm under dynamics, one for each route at the action level."""
