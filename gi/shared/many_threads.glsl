// Numbers for more threads along x than OpenGL counts (65535 groups at least): Program::dispatch makes rows of them. The
// last numbers may be beyond what was asked for.
uniform uint threads_a_row;  // 0: there is one row

uint thread_number() { return gl_GlobalInvocationID.x + gl_GlobalInvocationID.y * threads_a_row; }
