#version 450 core
// Only the depth is wanted.
void main()
{
}
